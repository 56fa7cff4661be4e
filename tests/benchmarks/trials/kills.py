"""Kills of a mission at random points, each resumed: what became of its stones."""

import sys
import tempfile
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held

TOY = Path(__file__).parents[2] / "mission" / "resume" / "toy"
MOST_KILLS = 6  # of one mission; a mission costs as much time as four kills
NONE = Bound(0)


def measured(wanted: int, seed: int) -> list[Figure]:
    """Kill missions until there are so many kills; return how many missions came out wrong."""
    sys.path.insert(0, str(TOY))
    import toy_site

    rng = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as folder:
        mission = toy_site.install(Path(folder) / "toy")
        import kills  # of the toy, whose folder comes first on the path

        whole = kills.trial(mission, Path(folder) / "whole", [])
        alone = "; ".join(whole["complaints"]) or "none"
        figures = [held("complaints without a kill", len(whole["complaints"]), NONE, alone)]
        if whole["complaints"]:
            return figures
        done, missions, wrong = 0, 0, 0
        while done < wanted:
            count = int(rng.integers(1, MOST_KILLS + 1))
            points = [kills.Kill.drawn(rng, whole["counts"]) for _ in range(count)]
            found = kills.trial(mission, Path(folder) / "run", points)
            done, missions = done + found["kills"], missions + 1
            if found["complaints"]:
                wrong += 1
                print(f"{points}: {found['complaints']}", flush=True)
            print(f"{done} kills, {missions} missions, {wrong} wrong", flush=True)
    what = "missions with a stone lost, doubled, dropped or misplaced"
    return [*figures, held(what, wrong, NONE, f"{wrong} of {missions} ({done} kills)")]
