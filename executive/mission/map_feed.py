"""Scan pairs on their way to the mapper, which on the wall clock a thread beside the tick fuses."""

from collections import deque
from collections.abc import Sequence

from executive.interfaces.mapping import Mapper
from executive.leaf.job import Job
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.mission.jobs.jobs import Jobs


class MapFeed:
    """Hands pairs to the thread that also computes what leaves ask of the map, in that order.

    So a cloud that is asked for holds every pair that came before.
    """

    def __init__(self, mapper: Mapper, jobs: Jobs) -> None:
        self._mapper = mapper
        self._jobs = jobs
        self._pending: deque[Job[int]] = deque()

    @property
    def behind(self) -> int:
        """Number of pairs that are not fused yet."""
        return len(self._pending)

    def send(self, scans: Sequence[LidarScan], motion: Motion) -> None:
        """Let a pair be fused."""
        self._pending.append(self._jobs.start(self._mapper.add_scan_pair, scans, motion))

    def take_fused(self) -> int:
        """Return how many pairs have been fused since this was asked last.

        Raises:
            Exception: What the mapper raised; a `CallError` if it came to no answer.
        """
        fused = 0
        while self._pending and self._pending[0].is_ready():
            self._pending.popleft().result()
            fused += 1
        return fused

    def settle(self) -> int:
        """Wait until all pairs are fused, and return how many that were.

        Raises:
            Exception: As `take_fused`.
        """
        fused = 0
        while self._pending:
            self._pending.popleft().result()
            fused += 1
        return fused
