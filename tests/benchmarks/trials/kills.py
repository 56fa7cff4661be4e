"""Kills of a mission at random points, each resumed: what became of its stones."""

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held

from executive.interfaces.report import MissionReport

CARRY = Path(__file__).parents[3] / "docs" / "campaigns" / "missions" / "faulty_carry.yaml"
NEAR_M = 0.3  # of its slot, and of its pose in the database
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


def in_simulation(wanted: int, seed: int, mission_seed: int) -> list[Figure]:
    """Kill a mission in the simulated world, whose truth says what became of its stone."""
    sys.path.insert(0, str(TOY))
    import kills

    rng, done, missions, wrong = np.random.default_rng(seed), 0, 0, 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "run"
        whole = kills.trial(CARRY, folder, [], mission_seed, complaints_of)
        alone = "; ".join(whole["complaints"]) or "none"
        figures = [held("complaints without a kill", len(whole["complaints"]), NONE, alone)]
        while done < wanted and not whole["complaints"]:
            points = [kills.Kill.drawn(rng, whole["counts"]) for _ in range(2)]
            found = kills.trial(CARRY, folder, points, mission_seed, complaints_of)
            done, missions = done + found["kills"], missions + 1
            wrong += bool(found["complaints"])
            print(f"{done} kills, {missions} missions: {points} {found['complaints']}", flush=True)
    what = "simulated missions with a stone lost, doubled, dropped or misplaced"
    return [*figures, held(what, wrong, NONE, f"{wrong} of {missions} ({done} kills)")]


def complaints_of(_robot: object, stones: Sequence[Any], report: MissionReport) -> list[str]:
    """Return what is wrong with the one stone in the end, by the simulator's truth."""
    if report.outcome != "success":
        return [f"{report.outcome}: {report.reason}"]
    found = [] if len(stones) == 1 else [f"the database has {len(stones)} stones for 1"]
    found += ["the stone is still held" for one in stones if one.state.value == "held"]
    if report.counts.placed != 1:
        found.append(f"{report.counts.placed} stones placed")
    assert report.truth is not None
    assert report.truth.grasps is not None
    for one in report.truth.stones:
        errors = {"slot": one.slot_error_m, "database": one.database_error_m}
        found += [f"{key} {e} m" for key, e in errors.items() if e is None or e > NEAR_M]
    return found + ["a stone fell" for one in report.truth.grasps if one.dropped]
