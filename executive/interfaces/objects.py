"""The object database: which stones there are, and where."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from executive.arrays import Float
from executive.interfaces.plugin import Plugin
from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent


class ObjectDatabase(Plugin, ABC):
    """Keep identities, clouds and poses of stones while they are moved (Mascaro 2020, Sec. 4.5).

    Each call is one transaction; what returned is on the disk.
    """

    capability = "objects"

    @abstractmethod
    def open(self, path: str, read_only: bool = False) -> None:
        """Open or create the database file; `:memory:` keeps nothing. Called once, after `start`.

        Opened read-only, an existing file can be looked at while a mission writes to it, and every
        change is refused.

        Raises:
            ConfigError: If there is no such folder, or no such file to look at.
            DataError: If it is another kind of file.
        """

    @abstractmethod
    def observe(
        self, segments: Sequence[Segment], stamp_s: float, seen_from_above: bool
    ) -> tuple[Stone, ...]:
        """Match segments of the map with known stones that lie on the ground, update those, and add
        the rest.

        Returns:
            The stone of each segment, in the order of the segments.
        """

    @abstractmethod
    def stones(self) -> tuple[Stone, ...]:
        """Return all stones, by id."""

    @abstractmethod
    def stone(self, stone_id: int) -> Stone:
        """Return one stone as it is now.

        Raises:
            DataError: If there is none of that id.
        """

    @abstractmethod
    def history(self, stone_id: int) -> tuple[StoneEvent, ...]:
        """Return what happened to a stone, oldest first: the first is when it was found.

        Raises:
            DataError: If there is none of that id.
        """

    @abstractmethod
    def grasp(self, stone_id: int, T_map_gripper: Float, stamp_s: float) -> Stone:
        """Note that the gripper holds the stone, and its pose at that moment."""

    @abstractmethod
    def release(
        self, stone_id: int, T_map_gripper: Float, stamp_s: float, state: StoneState
    ) -> Stone:
        """Move the stone by what the gripper moved since the grasp (Eq. 3), and set its state."""

    @abstractmethod
    def realign(self, stone_id: int, T_map_map: Float, stamp_s: float, note: str = "") -> Stone:
        """Correct the stone's pose by a rigid motion in the map, found by alignment; the note says
        how it was.
        """

    @abstractmethod
    def set_state(self, stone_id: int, state: StoneState, stamp_s: float) -> Stone:
        """Change the stone's state only."""
