"""Where plans of structures are tried without a machine, and what judges the result."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.messages.building import AsBuilt
from executive.messages.solid_stone import SolidStone


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """What became of one release.

    Attributes:
        poses: Poses of all stones at the end, the new one last, shape (4, 4) each.
        moved_m: Largest displacement of a stone that stood before [m].
        is_at_rest: Whether everything was at rest in the end.
    """

    poses: Sequence[Float]
    moved_m: float
    is_at_rest: bool


class TrialSite(ABC):
    """Lets stones go where a plan says, with noise; entry points `executive.trial_site.v1`."""

    @abstractmethod
    def place(
        self,
        built: AsBuilt,
        stone: SolidStone,
        T_map_stone: Float,
        noise: tuple[float, float],
        rng: np.random.Generator,
    ) -> Settled:
        """Lower a stone until it touches, let it go, and return where everything comes to rest.

        Args:
            built: The structure before.
            stone: The stone.
            T_map_stone: Pose over which it is lowered, shape (4, 4).
            noise: Standard deviations of the release along each axis of the ground [m], and of its
                rotation about each axis [rad].
            rng: The only source of chance.
        """


class StructureJudge(ABC):
    """Rates a structure by its stones' poses alone; entry points `executive.judge.v1`.

    It is run in a process of its own, and shares neither time step nor friction with the planner or
    the trial site.
    """

    @abstractmethod
    def judge(self, built: AsBuilt) -> Mapping[str, object]:
        """Return the figures of a structure as plain values, SI units in the names."""
