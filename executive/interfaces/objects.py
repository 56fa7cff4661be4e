"""The object database: which stones there are, and where."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from executive.arrays import Float
from executive.interfaces.plugin import Plugin
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent
from executive.messages.weight import Weight


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
        the rest. What lies in the body of a known stone is a piece of it, and no stone of its own.

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

    def reshape(self, stone_id: int, points_map: Float, stamp_s: float, note: str = "") -> Stone:
        """Replace the stone's known surface by a better one, at its present pose [m], shape (N, 3);
        the note says how that was seen. By default it is not kept.
        """
        return self.stone(stone_id)

    def weigh(self, stone_id: int, weight: Weight, stamp_s: float) -> Stone:
        """Note what the stone weighs; by default it is not kept."""
        return self.stone(stone_id)

    def keep_grasp(self, stone_id: int, T_object_gripper: Float, stamp_s: float) -> Stone:
        """Note a pose of the gripper in the stone's frame that has held it on its whole way; by
        default it is not kept.
        """
        return self.stone(stone_id)

    @abstractmethod
    def set_state(self, stone_id: int, state: StoneState, stamp_s: float) -> Stone:
        """Change the stone's state only."""

    @abstractmethod
    def surroundings(self, map_cloud: Cloud, without: int | None = None) -> Cloud:
        """Return the map merged with the models of the lying stones (Sec. 5.2), at one density.

        Args:
            map_cloud: The map, in the frame `map`.
            without: Id of a stone whose model and map points are left out, such as the one that is
                held.

        Raises:
            DataError: If there is no stone of that id.
        """

    @abstractmethod
    def unexplained(self, map_cloud: Cloud, stone_id: int, radius_m: float) -> Cloud:
        """Return the map around a stone's centroid without the points of other lying stones.

        Ground and the stone's own points are kept. Ground below another stone, which was seen
        before that stone lay there, may be left out.

        Args:
            map_cloud: The map, in the frame `map`.
            stone_id: The stone whose surroundings are returned.
            radius_m: Largest horizontal distance from the stone's centroid [m].

        Raises:
            DataError: If there is no stone of that id.
        """

    @abstractmethod
    def surface_within(
        self, centre_map: Float, radius_m: float, without: int | None = None
    ) -> Float:
        """Return the points of lying stones' models that are in a sphere of the map.

        Args:
            centre_map: Centre of the sphere [m], shape (3,).
            radius_m: Its radius [m].
            without: Id of a stone that is left out.

        Returns:
            Points in the map [m], in order of the stones' ids, shape (N, 3).
        """
