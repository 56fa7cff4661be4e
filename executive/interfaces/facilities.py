"""What a robot may offer beside its interface: a simulated scene, photographs of the site."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from executive.arrays import Float
from executive.messages.cloud import Cloud


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


class SurveyedAside(ABC):
    """A simulated robot of whose site a copy can be surveyed while its own world goes on."""

    @abstractmethod
    def site_now(self) -> Scene:
        """Return the site as it is now; what happens to the robot's own changes nothing in it."""


class SurveyedElsewhere(ABC):
    """A machine in another process, which makes the survey of its own simulated site."""

    @abstractmethod
    def survey_of_site(self, seed: int) -> Cloud:
        """Return the survey that the mission selects, as that process makes it; waits for it.

        Args:
            seed: All chance of the survey follows from it.

        Raises:
            DataError: If the machine has no survey, or it came to none; the message says why.
        """


FACILITIES: Mapping[str, type] = {"scene": Scene, "photographs": Photographer}
