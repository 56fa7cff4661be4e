"""What progress shows: the states of nodes, with the words of the modifiers around them."""

from typing import Any

from executive.tree.build import node_states

MAIN = """
sequence:
  - wait: 0.1 s
    name: first
  - fallback:
      - check: Calm
        if: {not: Calm}
      - run: Scan
        with: {duration: 5 s}
        timeout: 0.3 s
        retry: 3
  - wait: 1 s
"""


def states(tree: Any) -> dict[str, tuple[int, str, str, bool]]:
    return {
        s.name: (s.depth, s.status, s.feedback, s.is_worth_showing) for s in node_states(tree.root)
    }


def test_rows_are_the_nodes_of_the_file_parents_first(play: Any) -> None:
    tree = play(MAIN)
    rows = node_states(tree.root)
    assert [(row.path, row.depth) for row in rows] == [
        ("main", 0),
        ("main/0:first", 1),
        ("main/1:fallback", 1),
        ("main/1:fallback/0:Calm", 2),
        ("main/1:fallback/1:Scan", 2),
        ("main/2:wait", 1),
    ]
    assert [row.is_worth_showing for row in rows] == [True, False, False, False, False, False]


def test_what_runs_and_what_lies_beside_it_is_worth_showing(play: Any) -> None:
    tree = play(MAIN)
    tree.tick(3)
    shown = states(tree)
    assert shown["first"] == (1, "SUCCESS", "", True)
    assert shown["Scan"][1] == "RUNNING"
    assert all(is_shown for _, _, _, is_shown in shown.values())


def test_the_attempt_under_way_is_told_with_the_node(play: Any) -> None:
    tree = play("run: Scan\nwith: {duration: 5 s}\nretry: 3\non_failure: {wait: 1 s}\nwhile: "
"Calm\ntimeout: 9 s",
                leaves={"Scan": failing_scan()})  # fmt: skip
    tree.tick(12)
    row = node_states(tree.root)[0]
    assert (row.status, row.feedback) == ("RUNNING", "attempt 2 of 3")


def failing_scan() -> type:
    from executive.config import Seconds, Settings
    from executive.leaf.action import Action, Steps
    from executive.leaf.outcome import failed

    class ScanSettings(Settings):
        duration: Seconds = 1.0

    class Scan(Action[ScanSettings]):
        begun = 0

        def run(self) -> Steps[None]:
            type(self).begun += 1
            while type(self).begun > 1:
                yield None
            yield from ()
            return failed("dazzled")

    return Scan
