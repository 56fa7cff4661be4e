"""What a robot may offer beside its interface: a simulated scene, photographs of the site."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from executive.arrays import Float


class Breakable(ABC):
    """A simulated robot whose drives can lose pressure, for faults on purpose."""

    @abstractmethod
    def weaken(self, joint: str, share: float) -> None:
        """Let the drive of a joint, or of the jaws, have a share of its effort; 1 is sound."""


class Scene(ABC):
    """A simulated robot's surroundings, as an external camera or lidar would see them."""

    @abstractmethod
    def cast_rays(self, origins_world: Float, directions_world: Float) -> Float:
        """Return the range [m] to the first surface along each unit direction, inf for none."""


class Photographer(ABC):
    """A simulated robot's site as a drone's camera would photograph it beforehand."""

    @abstractmethod
    def photograph(
        self, T_world_opticals: Sequence[Float], size_px: tuple[int, int], view_angle_rad: float
    ) -> Iterator[NDArray[np.uint8]]:
        """Yield one picture a pose: red, green, blue, shape (height, width, 3).

        Args:
            T_world_opticals: Poses of a pinhole camera; z looks forward, x right, y down, (4, 4)
                each.
            size_px: Width and height of the pictures.
            view_angle_rad: Opening angle across the width [rad].

        Raises:
            RobotError: If this computer cannot draw without a screen; the message names the cure.
        """


FACILITIES: Mapping[str, type] = {"scene": Scene, "photographs": Photographer}
