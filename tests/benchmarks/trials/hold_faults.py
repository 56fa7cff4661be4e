"""Carries with faults in mid-carry, watched by `hold_state`, judged by the simulator."""

import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.monitoring.hold_state import HoldState
from executive_plugins.monitoring.settings import HoldStateSettings

from executive.arrays import Float
from executive.behaviours.is_hanging import IsHangingSettings
from executive.geometry.pose import inverse
from executive.interfaces.monitoring import Monitor
from executive.messages.command import MoveJaws
from executive.messages.ground_below import GroundBelow
from executive.messages.joints import JointSample
from executive.messages.verdict import Trouble, Verdict
from executive.messages.weight import Weight
from executive.tree.load import load_mission
from trials.grasp_attempts import A_SITE, Site, attempt, lay_out
from trials.grasp_rows import World, shapes_of

FAULTS = ("pressure", "none", "open", "wet")
WET = (0.05, 0.005)  # friction of steel on a wet stone: Coulomb's, and torsional [m]
EARLIEST_S, LATEST_S = 3.0, 10.0  # after the grasp; a carry takes 13 s
MOVED_M, LOST_M = 0.03, 0.3
FIRM_S = 1.0  # before a fault, in which the stone is not to move
IN_TIME_S = 0.5
CLEAR_M = 0.2  # above the lowest place of the stone in a hold: the ground is some cm uneven
STANDS = IsHangingSettings().probability


@dataclass
class Hold:
    """What happened in one hold: the fault, the stone's centre in the jaws over time, verdicts."""

    fault: str
    mass_kg: float
    fault_s: float = np.nan
    stamps_s: list[float] = field(default_factory=list)
    centres_m: list[Float] = field(default_factory=list)
    heights_m: list[float] = field(default_factory=list)  # of that centre in the map
    standing: list[float] = field(default_factory=list)  # probability that the ground carries it
    told: list[Verdict] = field(default_factory=list)
    weight: Weight | None = None
    carried_s: float = np.nan  # when the trial lift had found that it hangs

    @property
    def is_carried(self) -> bool:
        return not np.isnan(self.carried_s)

    def moved_m(self, since_s: float = -np.inf) -> Float:
        """Return how far the stone has moved in the jaws since a time, or the begin of the hold."""
        i = min(int(np.searchsorted(self.stamps_s, since_s)), len(self.stamps_s) - 1)
        moved: Float = np.linalg.norm(np.array(self.centres_m) - self.centres_m[i], axis=1)
        return np.where(np.arange(len(moved)) < i, 0.0, moved)

    @property
    def stands_in_air(self) -> bool:
        """Whether the ground was said to carry the stone while that was far above it."""
        heights = np.array(self.heights_m)
        carried = heights - heights.min() > CLEAR_M
        return bool((np.array(self.standing)[carried] >= STANDS).any())

    @property
    def is_lost(self) -> bool:
        return bool(self.moved_m().max() > LOST_M)

    @property
    def is_firm_at_fault(self) -> bool:
        """Whether the stone was carried, nothing was told and it did not move when a fault came."""
        if self.fault == "none" or np.isnan(self.fault_s) or not self.is_carried:
            return False
        before_m = self.slid_m(self.fault_s - FIRM_S, self.fault_s)
        return before_m < MOVED_M and self.late_s(self.fault_s) >= 0.0

    def slid_m(self, since_s: float, until_s: float) -> float:
        """Return how far the stone moved in the jaws from one time to another, at most."""
        i = int(np.searchsorted(self.stamps_s, until_s))
        return float(self.moved_m(since_s)[: i + 1].max())

    def late_s(self, since_s: float) -> float:
        """Return the time to the first verdict; infinite if there was none."""
        return self.told[0].stamp_s - since_s if self.told else np.inf

    def late_after_m(self, way_m: float, since_s: float = -np.inf) -> float:
        """Return the time from when the stone had moved by some way to the first verdict."""
        return self.late_s(self.stamps_s[int(np.argmax(self.moved_m(since_s) > way_m))])


class Watched(Monitor):
    """Hands the samples to the monitor on trial, makes the fault, and keeps what is true."""

    def __init__(self, site: Site, monitor: HoldState) -> None:
        self._site, self._monitor = site, monitor
        self.hold: Hold | None = None
        self.at_s = np.inf

    def begin_hold(self) -> None:
        self._monitor.begin_hold()
        self._begun_s = self._site.now_s

    def begin_carry(self) -> None:
        self._monitor.begin_carry()
        if self.hold is not None:
            self.hold.carried_s = self._site.now_s

    def carry_over(self, below: GroundBelow) -> None:
        self._monitor.carry_over(below)

    def end_hold(self) -> None:
        self._monitor.end_hold()

    def update(self, sample: JointSample) -> Verdict | None:
        hold, i = self.hold, self._site.watched
        if hold is None or i is None:
            return None
        hold.stamps_s.append(sample.stamp_s)
        hold.centres_m.append((inverse(self._site.gripper()) @ self._site.T(i))[:3, 3])
        hold.heights_m.append(float(self._site.T(i)[2, 3]))
        if np.isnan(hold.fault_s) and sample.stamp_s - self._begun_s > self.at_s:
            hold.fault_s = sample.stamp_s
            self._make_fault(hold.fault, i)
        if (verdict := self._monitor.update(sample)) is not None:
            hold.told.append(verdict)
        hold.weight = self._monitor.weight()
        hold.standing.append(self._monitor.standing() or 0.0)
        return None

    def _make_fault(self, fault: str, i: int) -> None:
        robot, world = self._site.plugins["robot"], self._site.world
        if fault == "pressure":
            robot.weaken(self._site.machine.jaw.name, 0.0)
        elif fault == "open":
            force_n = self._site.machine.gripper.tip_force_n
            robot.command(MoveJaws(self._site.machine.jaw.upper, force_n))
        elif fault == "wet":
            stone = world.model.body(world.site.stones[i].name)
            geoms = range(int(stone.geomadr[0]), int(stone.geomadr[0]) + int(stone.geomnum[0]))
            # Else the numbers of steel decide.
            world.model.geom_priority[geoms] = world.model.geom_priority.max() + 1
            world.model.geom_friction[geoms, :2] = WET


def holds_of(number: int) -> Iterator[Hold]:
    """Carry the stones of one site, each once, and yield those that were held."""
    with tempfile.TemporaryDirectory() as folder:
        site = lay_out(World("generated"), "learned", number, Path(folder))
    monitor = HoldState(_as_shipped(), site.machine)
    monitor.start()
    watched = Watched(site, monitor)
    site.plugins["monitoring"] = [watched]
    site.run(1.0)
    rng, shapes, model = (
        np.random.default_rng(number),
        shapes_of(site.world.model),
        site.world.model,
    )
    for n, i in enumerate(sorted(range(A_SITE), key=lambda i: -shapes[i + 1][1])):
        fault = FAULTS[(n + A_SITE * number) % len(FAULTS)]
        watched.hold = Hold(fault, shapes[i + 1][1])
        watched.at_s = rng.uniform(EARLIEST_S, LATEST_S)
        friction, priority = model.geom_friction.copy(), model.geom_priority.copy()
        attempt(site, i, [], rng)
        model.geom_friction[:], model.geom_priority[:] = friction, priority
        site.plugins["robot"].weaken(site.machine.jaw.name, 1.0)
        if watched.hold.stamps_s:
            yield watched.hold


def _as_shipped() -> HoldStateSettings:
    """Return the monitor's settings in the shipped missions."""
    (monitor,) = load_mission("pick_and_place", ()).plugins["monitoring"]
    return cast(HoldStateSettings, monitor.settings)


def measured(sites: Iterable[int]) -> list[Figure]:
    """Carry the stones of some sites, and hold the verdicts against the truth."""
    holds = [hold for number in sites for hold in holds_of(number)]
    firm = [h for h in holds if h.is_firm_at_fault]
    late_s = [h.late_s(h.fault_s) for h in firm if h.fault in ("pressure", "open")]
    slid = [h for h in firm if h.fault == "wet" and h.is_lost]
    slid_s = [h.late_after_m(MOVED_M, h.fault_s) for h in slid]
    slipped = [h for h in holds if h.is_lost and not h.is_firm_at_fault]
    unseen = [h for h in slipped if h.is_carried and h.late_after_m(LOST_M) > IN_TIME_S]
    kept = [h for h in holds if h.fault == "none" and h.is_carried and not h.is_lost]
    # A stone that slips and stays, as at once after the trial, is told rightly.
    wrong = [h for h in kept if h.told and h.slid_m(h.carried_s, h.told[0].stamp_s) < MOVED_M]
    grounded = [h for h in kept if h.stands_in_air]
    doubled = [h for h in holds if [v.trouble for v in h.told].count(Trouble.DROP) > 1]
    off = [100 * abs(h.weight.mass_kg / h.mass_kg - 1) for h in (*firm, *kept) if h.weight]
    return [
        *_told("pressure lost or jaws opened", late_s),
        *_told("wet stone lost", slid_s),
        held(
            "badly gripped stones lost that neither the trial nor the monitor tells",
            len(unseen), Bound(0.0), f"{len(unseen)} of {len(slipped)}",
        ),
        held(
            "false verdicts in 300 holds", 300 * len(wrong) / max(len(kept), 1), Bound(1.0),
            f"{len(wrong)} of {len(kept)}",
        ),
        held(
            "holds with ground below a stone in the air", len(grounded), Bound(0.0),
            f"{len(grounded)} of {len(kept)}",
        ),
        held("falls told twice", len(doubled), Bound(0.0), f"{len(doubled)} of {len(holds)}"),
        held("mass error of firm holds, p95 [%]", float(np.percentile(off, 95)), Bound(8.0, 4.0)),
    ]  # fmt: skip


def _told(what: str, late_s: list[float]) -> Iterator[Figure]:
    """Yield the share told in time, and the median time."""
    in_time = [0.0 <= late <= IN_TIME_S for late in late_s]
    share = np.mean(in_time) if late_s else np.nan
    words = f"{sum(in_time)} of {len(late_s)}"
    yield held(f"{what}: told within {IN_TIME_S} s", float(share), Bound(1.0, is_least=True), words)
    median_s = float(np.median(late_s)) if late_s else np.nan
    yield held(f"{what}: median [s]", median_s, Bound(IN_TIME_S, 0.3))
