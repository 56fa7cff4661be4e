"""The nodes of a dry run do at each tick what those of a real run do."""

from executive.dry_run.dry_run import DryOptions, DryRun
from executive.events.node import NodeEnded, NodeStarted
from executive.journal import Journal
from executive.journal.reading import read_journal
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

# The nodes of the language alone: what leaves do is not compared.
MISSION = """api: 1
mission: nodes
plugins: {robot: {plugin: kinematic}, estimation: gnss_imu_filter}
trees:
  main:
    sequence:
      - set: {n: 0, xs: [1, 2, 3]}
      - parallel:
          - optional: true
            do: {wait: 1 h, timeout: 0.33 s}
          - retry: {attempts: 3, pause: 0.12 s}
            do:
              fallback:
                - check: "{n} > 2"
                - sequence: [{set: {n: "{n} + 1"}}, {wait: 0.07 s}, {check: "{n} > 2"}]
      - for_each: {item: x, in: "{xs}"}
        do: {wait: 0.1 s}
      - optional: true
        do:
          timeout: 0.9 s
          do:
            reactive_sequence:
              - set: {n: "{n} + 1"}
              - fallback: [{check: "{n} < 9"}, {wait: 0.2 s}]
              - wait: 0.5 s
      - call: deep
        in: {k: "{n}"}
  deep:
    in: {k: int}
    loop: {until: "{k} > 12", max: 30}
    do: {sequence: [{set: {k: "{k} + 1"}}, {wait: 0.1 s}]}
"""


def of_nodes(entries):
    return [
        (e.tick, e.time_s, e.node, e.event.payload())
        for e in entries
        if isinstance(e.event, NodeStarted | NodeEnded)
    ]


def test_its_journal_of_nodes_is_that_of_a_real_run(tmp_path):
    path = tmp_path / "nodes.yaml"
    path.write_text(MISSION)
    mission = load_mission(str(path))
    done = Run(mission, Options(run_dir=tmp_path / "run")).execute(lambda _: None)
    assert done.report.outcome == "success"
    journal, entries = Journal(), []
    journal.follow(entries.append)
    result = DryRun(mission, DryOptions(), journal).run()
    assert result.outcome == "success"
    real = of_nodes(read_journal(tmp_path / "run" / "journal.jsonl"))
    assert of_nodes(entries) == real
    assert len(real) > 60
