"""Play random trees on the executive and on the real BehaviorTree.CPP, and tell which differ.

Compared are the root's status at each tick, and every start, end and halt of every leaf, and every
question to a condition, in their order; over 14 ticks with conditions that change, timeouts, and
halts of the whole tree. Where the order within a tick is set by a timer, the events of the tick are
compared without it.
"""

import argparse
import json
import sys
from collections import Counter
from hashlib import sha256
from pathlib import Path

import ours
import real
from random_trees import TICKS, RandomScene, random_scene, scene_xml

RECORDED = Path(__file__).parent / "recorded" / "random_trees.jsonl"
USAGE = f"""examples:
  {real.VARIABLE}=BehaviorTree.CPP python tests/tree/btcpp/compare.py
  {real.VARIABLE}=BehaviorTree.CPP python tests/tree/btcpp/compare.py --count 300 --record

exit status: 0 if all are equal, 1 if some differ, 2 if the library is not there"""


def digest(scene: RandomScene) -> str:
    """Return what a recorded answer belongs to."""
    given = json.dumps([scene.main, scene.trees, scene.halts], sort_keys=True)
    return sha256(given.encode()).hexdigest()[:12]


def alike(one: list[str], other: list[str], scene: RandomScene) -> bool:
    """Whether two courses are equal."""
    if not scene.has_timers:
        return one == other
    return [_unordered(line) for line in one] == [_unordered(line) for line in other]


def _unordered(line: str) -> tuple[str, dict[str, list[str]]]:
    """Return the status, and the events of each leaf in their order."""
    status, *events = line.split()
    by_leaf: dict[str, list[str]] = {}
    for event in events:
        by_leaf.setdefault(event.rstrip("!+=sf?10")[:1] or event, []).append(event)
    return status, {leaf: sorted(several) for leaf, several in by_leaf.items()}


def main() -> int:
    """Compare, and tell."""
    command = argparse.ArgumentParser(
        description=__doc__, epilog=USAGE, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    command.add_argument("--seed", type=int, default=0, help="of the first tree (default: 0)")
    command.add_argument("--count", type=int, default=3000, help="of trees (default: 3000)")
    command.add_argument("--show", type=int, default=3, help="differences to show (default: 3)")
    command.add_argument("--record", action="store_true", help="keep the answers of the library")
    asked = command.parse_args()
    scenes = [random_scene(seed) for seed in range(asked.seed, asked.seed + asked.count)]
    missions = [ours.loaded(one.main, one.trees) for one in scenes]
    written = [scene_xml(mission) for mission in missions]
    given = [real.Scene(x, TICKS, 100, one.halts) for x, one in zip(written, scenes, strict=True)]
    try:
        answers = real.answers(given)
    except real.NotFoundError as error:
        print(f"not compared: {error}", file=sys.stderr)
        return 2
    counts: Counter[str] = Counter()
    for number, (scene, mission, answer) in enumerate(zip(scenes, missions, answers, strict=True)):
        played = ours.play(mission, TICKS, scene.halts)
        expected = answer.get("ticks", [answer.get("error", "")])
        is_alike = alike(played, expected, scene)
        counts["alike" if is_alike else "different"] += 1
        if not is_alike and counts["different"] <= asked.show:
            print(f"seed {asked.seed + number}: {json.dumps(scene.main)} {json.dumps(scene.trees)}")
            print(f"  ours {played}\n  real {expected}")
    if asked.record:
        lines = [
            json.dumps([seed, digest(scene), ";".join(answer["ticks"])])
            for seed, (scene, answer) in enumerate(zip(scenes, answers, strict=True), asked.seed)
        ]
        RECORDED.parent.mkdir(exist_ok=True)
        RECORDED.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{counts['alike']} of {len(scenes)} alike, {counts['different']} differ")
    return 1 if counts["different"] else 0


if __name__ == "__main__":
    sys.exit(main())
