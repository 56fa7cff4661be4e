"""The cases after BehaviorTree.CPP's own tests, in the mission language: read, played and counted.

A case is written anew from what a test of the library (4.10) expects; `case` names the test. In
trees, `~a:2fs` is an action `a` that takes 2 ticks and fails at its first start, `?c:10` a
condition whose answers change, `!{v}` a leaf that notes a value. `play` gives the expected line of
each tick in the words of program/player.cpp; H halts the tree, and `set` changes keys from outside.

What `form` says:
    (nothing)    the same nodes, the same result
    other shape  the same result from other nodes; `reason` says why
    differs      on purpose; `reason` is the number or row in docs/node_rules.md
    cannot       cannot be expressed
    interface    tests a C++ function or a rule of the XML that no tree can see; not counted
"""

import re
import sys
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import ours
import yaml

from executive.tree.language import MissionFile
from executive.tree.problem import MissionFileError

FOLDER = Path(__file__).parent / "cases"
FORMS = ("as written", "other shape", "differs", "cannot", "interface")
_ACTION = re.compile(r"~(\w+)(?::(\d+)([sfx]*))?")
_CONDITION = re.compile(r"\?(\w+)(?::([01]+))?")


@dataclass(frozen=True, slots=True)
class Case:
    """One case."""

    file: str
    case: str
    form: str = "as written"
    reason: str = ""
    main: Any = None
    trees: dict[str, Any] = field(default_factory=dict)
    store: dict[str, Any] = field(default_factory=dict)
    play: list[Any] = field(default_factory=list)
    told: list[str] = field(default_factory=list)
    stored: dict[str, Any] = field(default_factory=dict)
    refused: str = ""


def all_cases() -> list[Case]:
    """Return all cases of all files."""
    return [
        Case(path.stem, **given)
        for path in sorted(FOLDER.glob("*.yaml"))
        for given in yaml.safe_load(path.read_text(encoding="utf-8"))
    ]


def expanded(given: Any) -> Any:
    """Return a tree with its short forms written out."""
    if isinstance(given, dict):
        return {key: expanded(value) for key, value in given.items()}
    if isinstance(given, list):
        return [expanded(value) for value in given]
    if not isinstance(given, str):
        return given
    if action := _ACTION.fullmatch(given):
        name, ticks, ends = action.groups()
        return {"run": "Act", "with": {"id": name, "ticks": int(ticks or 0), "ends": ends or "s"}}
    if condition := _CONDITION.fullmatch(given):
        name, answers = condition.groups()
        return {"check": "Given", "with": {"id": name, "answers": answers or "1"}}
    return {"run": "Tell", "with": {"values": given[1:]}} if given.startswith("!") else given


def failure(case: Case) -> str:
    """Play a case; return what is not as expected, or an empty text."""
    if case.main is None:
        return "" if case.form in ("cannot", "interface") else "no tree is given"
    main, trees = expanded(case.main), expanded(case.trees)
    if case.store:  # the reader wants to see the keys written
        main = {"sequence": [{"set": case.store}, main]}
    try:
        mission = ours.loaded(main, trees)
    except MissionFileError as error:
        told = str(error)
        return "" if case.refused and case.refused in told else f"refused: {told}"
    if case.refused:
        return f"not refused with '{case.refused}'"
    mission = _without_set(mission) if case.store else mission
    return _played(case, ours.Player(mission, case.store))


def _without_set(mission: MissionFile) -> MissionFile:
    """Return a mission that begins with the second node of its sequence."""
    main = mission.trees["main"]
    only = replace(main, root=main.root.children()[1])
    return replace(mission, trees={**mission.trees, "main": only})


def _played(case: Case, player: ours.Player) -> str:
    for number, step in enumerate(case.play, 1):
        if isinstance(step, dict):
            for key, value in step["set"].items():
                player.runtime.store.set(key, value)
            continue
        line = player.halt() if step[0] == "H" else player.tick()
        if line != step:
            return f"step {number}: '{line}' instead of '{step}'"
    if case.told and player.runtime.told != case.told:
        return f"told {player.runtime.told} instead of {case.told}"
    found = {key: player.runtime.store.get(key) for key in case.stored}
    return "" if found == case.stored else f"stored {found} instead of {case.stored}"


def main() -> int:
    """Play all cases and print their number by form."""
    cases = all_cases()
    counts = Counter(case.form for case in cases)
    wrong = [(case, told) for case in cases if (told := failure(case))]
    for case, told in wrong:
        print(f"{case.file}: {case.case}: {told}")
    files = sorted({case.file for case in cases})
    print(f"{'':12}" + "".join(f"{form:>13}" for form in FORMS))
    for file in files:
        here = Counter(case.form for case in cases if case.file == file)
        print(f"{file:12}" + "".join(f"{here[form]:13}" for form in FORMS))
    print(f"{'all':12}" + "".join(f"{counts[form]:13}" for form in FORMS))
    counted = len(cases) - counts["interface"]
    print(f"{counts['as written']} of {counted} as written; {len(wrong)} not as expected")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
