"""Kills of a mission at random points, each resumed: what became of its stones."""

import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held

from executive.interfaces.report import MissionReport

PICK = Path(__file__).with_name("killed_pick.yaml")
NEAR_M = 0.3  # of its slot, and of its pose in the database
TOY = Path(__file__).parents[2] / "mission" / "resume" / "toy"
MOST_KILLS = 6  # of one mission; a mission costs as much time as four kills
NONE = Bound(0)
FALL = "a stone fell"


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


def in_simulation(wanted: int, seed: int, first_seed: int) -> list[Figure]:
    """Kill missions in the simulated world, each of a seed of its own, and run it without kills.

    Its truth says where the stone is in the end. A grasp may fail without a kill, too, and the
    mission tries again; so stones that fell on the way are told beside those without a kill.
    """
    sys.path.insert(0, str(TOY))
    import kills

    rng, done, ends = np.random.default_rng(seed), 0, _Ends()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "run"
        while done < wanted:
            mission_seed = first_seed + ends.missions
            whole = kills.trial(PICK, folder, [], mission_seed, complaints_of)
            points = [kills.Kill.drawn(rng, whole["counts"]) for _ in range(2)]
            found = kills.trial(PICK, folder, points, mission_seed, complaints_of)
            done += found["kills"]
            ends.count(whole["complaints"], found["complaints"])
            print(f"seed {mission_seed}, without a kill: {whole['complaints']}", flush=True)
            print(f"{done} kills, {points}: {found['complaints']}", flush=True)
    return ends.figures(done)


@dataclass
class _Ends:
    """What became of missions without and with kills."""

    are_wrong: list[tuple[bool, bool]] = field(default_factory=list)
    have_falls: list[tuple[bool, bool]] = field(default_factory=list)

    @property
    def missions(self) -> int:
        return len(self.are_wrong)

    def count(self, alone: list[str], killed: list[str]) -> None:
        self.are_wrong.append((bool({*alone} - {FALL}), bool({*killed} - {FALL})))
        self.have_falls.append((FALL in alone, FALL in killed))

    def figures(self, kills: int) -> list[Figure]:
        by_kills = sum(killed and not alone for alone, killed in self.are_wrong)
        what = "simulated missions with a stone lost, doubled or misplaced in the end"
        return [
            held(f"{what}, and not without a kill", by_kills, NONE, self._of(by_kills, kills)),
            Figure(what, self._beside(self.are_wrong)),
            Figure("simulated missions in which a stone fell", self._beside(self.have_falls)),
        ]

    def _of(self, count: int, kills: int) -> str:
        return f"{count} of {self.missions} ({kills} kills)"

    def _beside(self, found: list[tuple[bool, bool]]) -> str:
        alone, killed = (sum(one[i] for one in found) for i in (0, 1))
        return f"{killed} of {self.missions}; {alone} without a kill"


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
    return found + [FALL for one in report.truth.grasps if one.dropped]
