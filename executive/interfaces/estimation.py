"""State estimation: inertial, satellite, lidar and joint measurements to one state."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from executive.interfaces.plugin import Plugin
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement
from executive.messages.status_change import StatusChange


class Estimator(Plugin, ABC):
    """Estimate where the machine is. Samples arrive in order of arrival;
    their stamps may be older.
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
        """Take the joints, of which the turn joint ties the cabin to the chassis."""

    def add(self, observation: Observation | LidarIncrement) -> None:
        """Hand an observation to the verb that takes it; none takes scans, whose odometry is
        estimated before.
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
        """Return the newest state; its status says whether it may be used."""

    def account(self) -> Sequence[StatusChange]:
        """Return the changes of the status since the start, with their reasons; none where no
        account is kept.
        """
        return ()
