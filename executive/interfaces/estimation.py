"""State estimation: inertial, satellite, lidar and joint measurements to one state."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

from executive.interfaces.recorded_log import LogPlugin
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement
from executive.messages.status_change import StatusChange


class Estimator(LogPlugin, ABC):
    """Estimate the pose and velocity of the machine.

    Measurements are handed over in the order in which they arrive. Their stamps may be out of
    order, for some sensors deliver late.
    """

    capability = "estimation"

    @abstractmethod
    def add_imu(self, sample: ImuSample) -> None:
        """Propagate by one inertial sample."""

    @abstractmethod
    def add_gnss(self, fix: GnssFix) -> None:
        """Correct by one position fix."""

    @abstractmethod
    def add_odometry(self, increment: LidarIncrement) -> None:
        """Correct by one lidar increment."""

    @abstractmethod
    def add_joints(self, sample: JointSample) -> None:
        """Take a joint sample; the turn joint gives the pose of the cabin on the chassis."""

    def add(self, observation: Observation | LidarIncrement) -> None:
        """Hand an observation to the method for its kind.

        Lidar scans are ignored: a `LidarOdometry` turns them into increments beforehand.
        """
        if isinstance(observation, ImuSample):
            self.add_imu(observation)
        elif isinstance(observation, JointSample):
            self.add_joints(observation)
        elif isinstance(observation, GnssFix):
            self.add_gnss(observation)
        elif isinstance(observation, LidarIncrement):
            self.add_odometry(observation)

    @abstractmethod
    def state(self) -> BaseState:
        """Return the newest state; `BaseState.is_ready` tells whether it may be used.

        It is `INITIALISING` until enough was measured. Called several times a tick: be fast.
        A measurement twice, out of order, or of an unknown sensor changes no pose.
        """

    def account(self) -> Sequence[StatusChange]:
        """Return the changes of the status since the start, with their reasons.

        The default is an empty sequence, for estimators that keep no such record.
        """
        return ()

    @property
    def imu(self) -> str | None:
        """Frame of the inertial sensor that the state is propagated by.

        On a log the state is read after each sample of that sensor. None, the default, stands for
        the first inertial sensor in the log.
        """
        return None

    @property
    def refused(self) -> Mapping[str, int]:
        """Number of refused measurements by stream and reason; empty if they are not counted."""
        return {}

    @property
    def map_origin(self) -> tuple[float, float, float] | None:
        """Where the map's origin is: latitude [deg], longitude [deg], altitude above the ellipsoid
        [m]; the map is east, north and up there.

        None, the default, while it is not known, and in methods without satellites.
        """
        return None
