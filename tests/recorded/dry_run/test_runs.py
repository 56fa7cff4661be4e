"""Dry runs of small missions over seeds: the whole journal, what ended, and what was made up."""

import runpy
from pathlib import Path

import pytest

from executive.dry_run.chance import Chance
from executive.dry_run.dry_run import DryOptions, DryRun
from executive.journal import Journal
from executive.tree.catalogue import TableCatalogue
from executive.tree.load import load_mission

SMALL = runpy.run_path(str(Path(__file__).parents[2] / "dry_run" / "conftest.py"))
MISSIONS = {
    "looks": """
    sequence:
      - {run: Look, out: {rock: "{rock}", count: "{count}"}, retry: {attempts: 3, pause: 20 s}}
      - {run: Turn, in: {rock: "{rock}"}, timeout: 90 s, optional: true}
      - if: "{count} >= 3 and {rock.mass} > 500 kg"
        then: {wait: 3 min}
        else: {set: {light: true}}
""",
    "loops": """
    loop: {until: {not: Calm}, max: 4}
    do:
      fallback:
        - {do: {run: Turn}, if: Calm, timeout: 40 s}
        - {check: Seen}
        - {wait: 7 s}
""",
    "at once": """
    parallel:
      - {run: Turn, timeout: 100 s}
      - {loop: {max: 3}, do: {wait: 15 s}}
      - {do: {run: Look}, on_failure: {run: Turn}, retry: 2}
    succeed: 2
    fail: 2
""",
    "asks anew": """
    reactive_fallback:
      - {reactive_sequence: [{check: Calm}, {run: Turn}]}
      - {do: {loop: forever, do: {run: Look, optional: true}}, timeout: 1 s}
""",
    "asks a person": """
    sequence:
      - {ask: "Which?", choices: [left, right], out: {answer: "{side}"}}
      - switch: "{side}"
        cases: {left: {run: Turn}, right: {wait: 2 s}}
        else: {run: Look}
""",
}


@pytest.fixture
def mission(tmp_path):
    def load(main: str):
        path = tmp_path / "small.yaml"
        path.write_text(f"{SMALL['HEADER']}trees:\n  main:{main}", encoding="utf-8")
        return load_mission(str(path), (), TableCatalogue(SMALL["LEAVES"], SMALL["PLUGINS"]))

    return load


@pytest.mark.parametrize("name", MISSIONS)
@pytest.mark.parametrize("failures", [0.0, 0.3])
def test_runs(recorded, mission, name, failures) -> None:
    made, told = mission(MISSIONS[name]), {}
    for seed in range(3 if failures else 1):
        journal, lines = Journal(), []
        journal.follow(
            lambda e, lines=lines: lines.append(
                f"{e.tick} {e.time_s!r} {e.node} {e.kind} {e.event.payload()}"
            )
        )
        options = DryOptions(Chance(seed, failures), preset=lambda choices: choices[-1])
        result = DryRun(made, options, journal).run()
        ends = [f"{path} {end}" for path, end in result.ends]
        lines += [f"{result.outcome} {result.reason} {result.ended_s!r}", *ends]
        told[str(seed)] = ["\n".join(lines), {k: repr(v) for k, v in result.made_up.items()}]
    recorded(told)
