"""Sixty mistakes that authors of missions make: what is written, and what the message has to say.

Each replaces one line of a good mission. `python tests/tree/typical_mistakes.py` prints the table
of all messages; read it after a change of words.
"""

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError, Problem

GOOD = """\
api: 1
mission: mine
extends: base
loop: {time_limit: 2 h}
plugins:
  estimation: {plugin: gnss_imu_filter}
  placing: {plugin: slots, drop_m: 5 cm}
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - set: {count: 3, heading: 30 deg, label: "north", done: false}
      - run: SurveySite
      - call: map_and_segment
      - run: FindSlots
        with: {count: 7}
      - check: "{count} > 2"
      - retry: 3
        do: {run: ScanSwing, with: {duration: 20 s}}
      - for_each: {item: slot, in: "{slots}"}
        do: {call: visit, in: {slot: "{slot}", count: "{count}"}}
      - wait: 5 s
        name: a pause
  visit:
    in: {slot: Slot, count: int}
    wait: 1 s
"""


@dataclass(frozen=True)
class Mistake:
    """A line of the good mission, what stands there instead, and a part of the cure.

    Attributes:
        line: A part of the line that is replaced.
        old: What is replaced in it.
        new: What stands there instead.
        cure: What the message has to hold; empty where none is expected.
        below: How many lines below the replaced one the mistake is.
    """

    line: str
    old: str
    new: str
    cure: str
    below: int = 0


MISTAKES = (
    # types and units
    Mistake("slot: Slot, count", "slot: Slot", "slot: Slto", "Did you mean 'Slot'?"),
    Mistake("slot: Slot, count", "count: int", "count: itn", "Did you mean 'int'?"),
    Mistake('"{count} > 2"', "> 2", "> 2 m", "multiply it, as in '{count} * 1 m'"),
    Mistake('"{count} > 2"', "{count} > 2", "max({count}, 3 t) > 2 t", "'{count} * 1 kg'"),
    # names
    Mistake("run: Localise", "Localise", "Localize", "Did you mean 'Localise'?"),
    Mistake("run: SurveySite", "SurveySite", "surveysite", "Did you mean 'SurveySite'?"),
    Mistake("run: FindSlots", "run:", "rum:", "Did you mean 'run'?"),
    Mistake("sequence:", "sequence", "sequense", "Did you mean 'sequence'?"),
    Mistake("call: map_and", "map_and_segment", "map_and_segmnt", "Did you mean 'map_and_segment'"),
    Mistake("with: {count: 7}", "count", "counts", "Did you mean 'count'?"),
    Mistake("with: {count: 7}", "with", "wiht", "Did you mean 'with'?"),
    Mistake("timeout: 30 s", "timeout", "time_out", "Did you mean 'timeout'?"),
    Mistake("plugin: gnss_imu", "gnss_imu_filter", "gnss_imu", "Did you mean 'gnss_imu_filter'"),
    Mistake("placing:", "placing", "plaicng", "Did you mean 'placing'?"),
    Mistake("drop_m: 5 cm", "drop_m", "drop", "Did you mean 'drop_m'?"),
    Mistake("time_limit", "time_limit", "timelimit", "Did you mean 'time_limit'?"),
    Mistake("extends: base", "base", "bass", "Did you mean 'base'?"),
    Mistake("mission: mine", "mission", "misson", "Did you mean 'mission'?"),
    Mistake("- call: map_and", "- call", "- run", "write 'call: map_and_segment'"),
    Mistake("in: {slot: \"{slot}\"", "{slot: ", "{slott: ", "Did you mean 'slot'?"),
    # units and types
    Mistake("timeout: 30 s", "30 s", "30 sec", "s, ms, min, h"),
    Mistake("timeout: 30 s", "30 s", "30 kg", "s, ms, min, h"),
    Mistake("wait: 5 s", "5 s", "5 m", "s, ms, min, h"),
    Mistake("drop_m: 5 cm", "5 cm", "5 deg", "m, cm, mm, km"),
    Mistake("drop_m: 5 cm", "5 cm", "-5 cm", "greater than or equal to 0"),
    Mistake("with: {count: 7}", "7", '"7"', "integer"),
    Mistake("with: {count: 7}", "7", "7.5", "integer"),
    Mistake("with: {count: 7}", "7", "0", "greater than"),
    Mistake("duration: 20 s", "20 s", "true", "a number in s, or with a unit"),
    Mistake("retry: 3", "3", "0", "at least 1"),
    Mistake("retry: 3", "3", "many", "whole number"),
    Mistake("time_limit: 2 h", "2 h", "2 hours", "s, ms, min, h"),
    Mistake("wait: 5 s", "5 s", "0 s", "more than 0 s"),
    # traps of YAML
    Mistake("done: false", "false", "no", "write false, or quote it"),
    Mistake("done: false", "false", "on", "write true, or quote it"),
    Mistake("wait: 5 s", "5 s", "12:30", "write a unit"),
    Mistake("with: {count: 7}", "7", "007", "drop the leading zero"),
    Mistake("      - wait: 5 s", "      - wait", "\t- wait", "indent with spaces"),
    Mistake("name: a pause", "a pause", "*pause", "write the value out"),
    Mistake("name: a pause", "a pause", "&pause x", "write the value out"),
    Mistake("timeout: 30 s", "timeout: 30 s", "run: SurveySite", "the first is at line 11"),
    Mistake("name: a pause", "a pause", "a: pause", "quote the text"),
    Mistake("name: a pause", "a pause", '"a pause', "a quote is not closed", below=4),
    Mistake("with: {count: 7}", "7}", "7", "is not closed", below=1),
    Mistake('in: "{slots}"', '"{slots}"', "{slots}", "in quotes"),
    # indentation and shape
    Mistake("        timeout: 30 s", "        timeout", "       timeout", "line up", below=0),
    Mistake("- run: SurveySite", "run: SurveySite", "SurveySite", "did you mean 'run: SurveySite'"),
    Mistake("do: {call: visit", "do:", "then:", "the body of 'for_each' stands under 'do:'"),
    Mistake("do: {run: ScanSwing", "do: {run: ScanSwing, with: {duration: 20 s}}",
            "optional: true", "'do:'", below=-1),
    Mistake("name: a pause", "name: a pause", "run: Localise", "into a 'sequence'"),
    Mistake("name: a pause", "name: a pause", "else: {wait: 1 s}", "'else' goes with"),
    Mistake("name: a pause", "name: a pause", "with: {a: 1}", "gives settings to a leaf"),
    # keys and their order
    Mistake('check: "{count} > 2"', "{count}", "{coutn}", "Did you mean 'count'?"),
    Mistake("- run: SurveySite", "run: SurveySite", "wait: 1 s", "SurveySite writes it", below=1),
    Mistake('in: "{slots}"', "{slots}", "{slot}", "never before this"),
    Mistake("- run: Localise", "run: Localise", 'check: "{count} > 1"', "never before this"),
    Mistake('in: "{slots}"', "{slots}", "{count}", "a list"),
    # expressions
    Mistake('check: "{count} > 2"', "{count} > 2", "{count} = 2", "compare with '=='"),
    Mistake('check: "{count} > 2"', "{count} > 2", "{count", "expected"),
    Mistake('check: "{count} > 2"', "{count} > 2", "{count} + 1", "needs true or false"),
    Mistake('check: "{count} > 2"', "{count} > 2", "{heading} > 2 s", "units of one dimension"),
    Mistake('check: "{count} > 2"', "{count} > 2", "{count} > '2'", "cannot compare"),
    # calls and modifiers
    Mistake("in: {slot: Slot", "count: int", "count: int, size: int", "before it is written", -4),
    Mistake('count: "{count}"}}', 'count: ', 'speed: ', "no input 'speed'"),
    Mistake("wait: 1 s", "wait: 1 s", 'call: visit', "'loop' or 'retry'"),
    Mistake("name: a pause", "name: a pause", "optional: maybe", "true or false"),
    Mistake("do: {run: ScanSwing", "do: {", "do: {optional: true, retry: 2, ", "around this one"),
    Mistake("- check:", 'check: "{count} > 2"',
            "parallel: [{run: ScanSwing}, {run: ScanSwing}]", "put them into a sequence"),
)  # fmt: skip


def written(mistake: Mistake) -> tuple[str, int]:
    """Return the mission with the mistake, and the line where it is."""
    lines = GOOD.splitlines()
    at = next(i for i, line in enumerate(lines) if mistake.line in line)
    assert mistake.old in lines[at]
    lines[at] = lines[at].replace(mistake.old, mistake.new, 1)
    return "\n".join(lines) + "\n", at + 1 + mistake.below


def problems_of(text: str) -> tuple[Problem, ...]:
    """Return what is wrong with a mission."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mine.yaml"
        path.write_text(text, encoding="utf-8")
        try:
            load_mission(str(path))
        except MissionFileError as error:
            return error.problems
    return ()


def main() -> int:
    """Print every mistake with its messages; return how many lines or cures are wrong."""
    wrong = 0
    for mistake in MISTAKES:
        text, line = written(mistake)
        found = problems_of(text)
        at = [one for one in found if one.mark.line == line]
        verdict = "ok"
        if not at:
            verdict = f"LINE {line}"
        elif not any(mistake.cure in one.message for one in at):
            verdict = f"CURE {mistake.cure!r}"
        wrong += verdict != "ok"
        print(f"{verdict:8} {mistake.old!r} -> {mistake.new!r}")
        for one in found:
            print(f"         {one.mark.line}:{one.mark.column}: {one.message}")
    print(f"{len(MISTAKES)} mistakes, {wrong} without the right line or cure")
    return wrong


if __name__ == "__main__":
    sys.exit(bool(main()))
