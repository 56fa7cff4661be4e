"""Ask whether a released stone stands where it was planned."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import Field

from executive.config import Meters, Radians, Settings
from executive.events.stone import PlacementVerified, StoneSetAside
from executive.geometry.pose import inverse, transform
from executive.interfaces.monitoring import Monitor
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.lost import mark_lost
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.sightings import is_turn_known, sightings
from executive.leaf.weighing import hanging_kg
from executive.messages.placement import Placement
from executive.messages.stone import Stone, StoneState

_WEIGHED_S = 1.0  # time over which a stone that seems to hang is weighed
_HANGS = 0.5  # share of the stone's weight above which it is still in the jaws


class VerifyPlacementSettings(Settings):
    position: Meters = Field(
        0.3, gt=0, le=5, description="Largest distance of the stone's centre from the plan [m]."
    )
    tilt: Radians = Field(
        0.35,
        gt=0,
        le=3.2,
        description="Largest tilt against the plan; turns about z are free [rad].",
    )
    otherwise: Literal["correct", "keep", "set_aside"] = Field(
        "correct",
        description="What a stone that is off becomes. correct: it lies on the ground, to be "
        "picked again, and this fails; keep: it stays as it stands; set_aside: it is not attempted "
        "again. One that was not seen is lost by each rule; with correct this fails.",
    )


@dataclass(frozen=True, slots=True)
class _Found:
    """Distance from the plan [m], tilt against it [rad], and what is wrong, if anything."""

    off_m: float
    tilt_rad: float
    reason: str


class VerifyPlacement(Action[VerifyPlacementSettings]):
    """Compare a stone's pose, as it was seen after the release, with the plan.

    It needs a scan and `RelocateAndRealign` or `FindAgain` before. A stone that was not recognised
    is unseen: it is not placed but lost, whatever the gripper's motion says. A stone whose weight
    is still on the arm hangs in the jaws, and is off; so is one that was seen there with another
    surface than its own, because it has turned. A stone that had turned over before this placement
    is compared by the surface that a look has shown since; that is told.
    """

    needs = (ObjectDatabase, Monitor)
    on_resume = OnResume.REDO

    def run(self, stone: int, placement: Placement) -> Steps[None]:
        """Compare, and record what was found.

        Args:
            stone: Id of the stone.
            placement: The placement that was carried out.
        """
        objects = self.context.use(ObjectDatabase)
        known = objects.stone(stone)
        left_kg = yield from self._hanging_kg()
        seen = sightings(objects, stone)
        if left_kg is None and not seen:
            return self._unseen(known, placement)
        found = self._compared(known, placement, left_kg, "replaced" in seen)
        self._record(known, placement, "off" if found.reason else "placed", found)
        if found.reason:
            return self._decided(known, f"stone {stone} {found.reason}")
        if known.state is not StoneState.PLACED:  # it was lost, and found at its place
            objects.set_state(stone, StoneState.PLACED, self.context.now_s())
        told = f"{found.off_m:.2f} m off, tilted by {found.tilt_rad:.2f} rad"
        if not is_turn_known(objects, stone):
            told += ", by a surface that is not the one it was found with"
        return succeeded(reason=told)

    def _hanging_kg(self) -> Generator[None, None, float | None]:
        """Return the mass in the jaws if it is most of the weighed stone's, else None.

        One sample alone says little: opened jaws that vibrate shake the arm by a tonne.
        """
        weight, mass_kg = self.context.weight(), self.context.payload_kg()
        if weight is not None and mass_kg is not None and mass_kg >= _HANGS * weight.mass_kg:
            mass_kg = yield from hanging_kg(self.context, _WEIGHED_S)
        if weight is None or mass_kg is None or mass_kg < _HANGS * weight.mass_kg:
            return None
        return mass_kg

    def _unseen(self, stone: Stone, placement: Placement) -> Outcome[None]:
        """Mark a stone that no look has shown since its release."""
        self._record(stone, placement, "unseen", None)
        reason = f"stone {stone.id} was not seen where it was set down"
        mark_lost(self.context, stone.id, reason)
        if self.settings.otherwise == "correct":
            return failed(reason)
        return succeeded(reason=f"{reason}; it is lost")

    def _compared(
        self, stone: Stone, placement: Placement, left_kg: float | None, has_turned: bool
    ) -> _Found:
        T_planned_now = stone.T_map_object @ inverse(placement.T_map_object)
        planned = transform(inverse(T_planned_now), stone.centroid_map[None])[0]
        off_m = float(np.linalg.norm(stone.centroid_map - planned))
        tilt_rad = float(np.arccos(np.clip(T_planned_now[2, 2], -1.0, 1.0)))
        wrong = []
        if left_kg is not None:
            wrong.append(f"hangs in the jaws with {left_kg:.0f} kg")
        if off_m > self.settings.position:
            wrong.append(f"is {off_m:.2f} m off its place")
        if tilt_rad > self.settings.tilt:
            wrong.append(f"is tilted by {np.degrees(tilt_rad):.0f}°")
        if has_turned:
            wrong.append("shows another surface than its own: it has turned")
        return _Found(off_m, tilt_rad, " and ".join(wrong))

    def _decided(self, stone: Stone, reason: str) -> Outcome[None]:
        """Do with a stone that is off what the mission asks for."""
        if self.settings.otherwise == "keep":
            return succeeded(reason=f"{reason}; kept as it is")
        objects, now_s = self.context.use(ObjectDatabase), self.context.now_s()
        if self.settings.otherwise == "set_aside":
            objects.set_state(stone.id, StoneState.SET_ASIDE, now_s)
            self.context.record(StoneSetAside(stone.id, reason))
            return succeeded(reason=f"{reason}; set aside")
        objects.set_state(stone.id, StoneState.ON_GROUND, now_s)
        return failed(reason)

    def _record(self, stone: Stone, placement: Placement, seen: str, found: _Found | None) -> None:
        self.context.record(
            PlacementVerified(
                stone=stone.id,
                slot=placement.slot.id,
                seen=seen,
                off_m=None if found is None else found.off_m,
                tilt_rad=None if found is None else found.tilt_rad,
                rule="" if seen == "placed" else self.settings.otherwise,
                reason=found.reason if found is not None else "not recognised after the release",
                turn_known=is_turn_known(self.context.use(ObjectDatabase), stone.id),
            )
        )
