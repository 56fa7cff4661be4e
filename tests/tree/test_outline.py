"""Each kind of node is shown by one line that says what matters of it."""

from pathlib import Path

from executive.tree.export import export
from executive.tree.load import load_mission

MISSION = """
api: 1
mission: every_kind
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
trees:
  main:
    sequence:
      - set: {count: 3, names: [a, b]}
      - parallel:
          - wait: 1 s
          - wait: 2 s
          - wait: 3 s
        succeed: 2
      - parallel:
          - wait: 1 s
          - wait: 2 s
          - wait: 3 s
        succeed: 1
        fail: 1
        wait_for_all: true
      - parallel:
          - wait: 1 s
          - wait: 2 s
        fail: 2
      - fallback:
          - check: "{count} > 2"
          - wait: 1 s
            name: the second
      - if: "{count} == 3"
        then: {wait: 1 s}
        else: {wait: 2 s}
      - while: "{count} > 3"
        do: {wait: 1 s}
      - switch: "{count}"
        cases:
          3: {wait: 3 s}
          4: {wait: 4 s}
        else: {wait: 5 s}
      - loop: {max: 3}
        do: {wait: 1 s}
      - loop: {until: "{count} == 3", max: 2}
        do: {wait: 1 s}
      - for_each: {item: one, in: "{names}"}
        do: {wait: 1 s}
      - consume: {item: one, from: "{names}"}
        do: {wait: 1 s}
      - ask: Go on?
        default: true
      - run: Localise
        timeout: 30 s
        retry: 2
        on_failure: {wait: 1 s}
        on_halt: {set: {count: 4}}
      - call: other
  other:
    wait: 1 s
"""
SHOWN = """\
main
sequence
|-- set count = 3, names = ['a', 'b']
|-- parallel, 2 of 3
|   |-- wait 1 s
|   |-- wait 2 s
|   `-- wait 3 s
|-- parallel, 1 of 3, fails with 1, waits for all
|   |-- wait 1 s
|   |-- wait 2 s
|   `-- wait 3 s
|-- parallel, 1 of 2
|   |-- wait 1 s
|   `-- wait 2 s
|-- fallback
|   |-- check {count} > 2
|   `-- wait 1 s (the second)
|-- if {count} == 3
|   |-- then: wait 1 s
|   `-- else: wait 2 s
|-- do  [while {count} > 3]
|   `-- wait 1 s
|-- switch {count}
|   |-- 3: wait 3 s
|   |-- 4: wait 4 s
|   `-- else: wait 5 s
|-- loop at most 3 rounds
|   `-- wait 1 s
|-- loop until {count} == 3, at most 2 rounds
|   `-- wait 1 s
|-- for_each one in {names}
|   `-- wait 1 s
|-- consume one from {names}
|   `-- wait 1 s
|-- ask "Go on?"
|-- run Localise  [timeout 30 s, retry 2]
|   |-- on failure: wait 1 s
|   `-- on halt: set count = 4
`-- call other

other
wait 1 s"""


def test_every_kind_of_node_is_shown_with_what_matters_of_it(tmp_path: Path) -> None:
    path = tmp_path / "every_kind.yaml"
    path.write_text(MISSION, encoding="utf-8")
    shown = export(load_mission(str(path)), "text")
    assert shown[shown.index("main\n") :].rstrip() == SHOWN
