"""Kill a mission with signal 9 at random points, resume it, and count what became of the stones.

Nothing may be lost, doubled, dropped or misplaced. On a machine without physics a kill takes about
ten seconds of one core.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

TOY = Path(__file__).parents[1] / "mission" / "resume" / "toy"
MOST_KILLS = 3  # of one mission


def main() -> int:
    """Run the campaign; the exit status is 1 if anything is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=200, help="number of kills (default: 200)")
    parser.add_argument("--seed", type=int, default=1, help="of the points (default: 1)")
    given = parser.parse_args()
    sys.path.insert(0, str(TOY))
    import toy_site

    with tempfile.TemporaryDirectory() as folder:
        mission = toy_site.install(Path(folder) / "toy")
        import kills

        whole = kills.trial(mission, Path(folder) / "whole", [])
        if whole["complaints"]:
            print(f"without a kill: {whole['complaints']}")
            return 1
        rng, done, missions, wrong = np.random.default_rng(given.seed), 0, 0, 0
        while done < given.kills:
            wanted = int(rng.integers(1, MOST_KILLS + 1))
            points = [kills.Kill.drawn(rng, whole["counts"]) for _ in range(wanted)]
            found = kills.trial(mission, Path(folder) / "run", points)
            done, missions = done + found["kills"], missions + 1
            if found["complaints"]:
                wrong += 1
                print(f"{points}: {found['complaints']}", flush=True)
            print(f"{done} kills, {missions} missions, {wrong} wrong", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
