"""A pause: the machine is held, mission time stands still, and the plugins are told.

The operator pauses a mission, or is asked something. The machine slows down along its path and
keeps it; when the pause ends, it goes on along the path from where it stands.
"""

from collections.abc import Callable, Mapping
from typing import Any

from executive.clock import Clock, wall_s
from executive.interfaces.plugin import Plugin
from executive.interfaces.report import PausesReport
from executive.interfaces.robot import Robot
from executive.leaf.rest import Rest
from executive.messages.joints import JointSample
from executive.mission.assembly import each_plugin


class Pause:
    """Holds the mission, and lets it go on.

    Attributes:
        count: Number of pauses so far.
        wall_s: How long they took on the wall [s].
    """

    # Of the newest pause: when it began, and when it ends once it is to end.
    _since_wall_s: float
    _began_s: float
    _ends_s: float

    def __init__(
        self,
        clock: Clock,
        plugins: Mapping[str, Any],
        on_error: Callable[[str, Plugin, Exception], None],
        brake_s: float = 0.0,
    ) -> None:
        """Make one that has not begun.

        Args:
            clock: The mission's clock.
            plugins: Who is told.
            on_error: Takes what a plugin raises when it is told.
            brake_s: How long the chassis may still roll after the stop: no joint shows that [s].
        """
        self._clock = clock
        self._robot: Robot = plugins["robot"]
        self._plugins = plugins
        self._on_error = on_error
        self._rest = Rest()
        self._brake_s, self._held_s = brake_s, 0.0
        self._is_ending = False
        self.stands = False
        self.count = 0
        self.wall_s = 0.0

    @property
    def is_on(self) -> bool:
        """Whether the mission is held."""
        return self._clock.is_paused

    @property
    def is_still(self) -> bool:
        """Whether nothing goes on at all: in lock-step, once the machine is at rest."""
        return self.is_on and self.stands and self._clock.stands_at_rest

    def begin(self) -> None:
        """Stop the machine along its path, and let mission time stand still."""
        self._hold()
        self._clock.pause()
        self._since_wall_s, self._began_s = wall_s(), self._clock.machine_s()
        self.count += 1
        self._tell(lambda plugin: plugin.paused(self._clock.now_s()))

    def watch(self, sample: JointSample | None) -> None:
        """Look in the newest sample whether the machine is at rest."""
        if self.is_on and not self.stands and not self._is_ending and sample is not None:
            now_s = self._clock.machine_s()
            rests = self._rest.add(now_s, sample.position, sample.velocity)
            self.stands = rests and now_s - self._held_s >= self._brake_s

    def must_wait(self, is_over: bool) -> bool:
        """Let the machine go on when the pause is to end; stop it again if the pause is to last.

        Args:
            is_over: Whether the mission is to go on.

        Returns:
            Whether mission time has to wait, because the machine would be late on its path.
        """
        if not is_over:
            if self._is_ending:
                self._hold()
            return False
        now_s = self._clock.machine_s()
        if self.is_on and not self._is_ending:
            self._ends_s = now_s + self._robot.behind_s()
            self._robot.resume()
            self._is_ending, self.stands = True, False
        return self.is_on and now_s < self._ends_s - 1e-9

    def _hold(self) -> None:
        self._robot.stop()
        self._rest, self.stands, self._is_ending = Rest(), False, False
        self._held_s = self._clock.machine_s()

    def end(self) -> float:
        """Let mission time go on, too; return the machine time that passed [s]."""
        self._tell(lambda plugin: plugin.resumed(self._clock.now_s()))
        return self.leave()

    def leave(self) -> float:
        """Let mission time go on, but not the machine; return the machine time that passed [s]."""
        if not self.is_on:
            return 0.0
        self._is_ending = False
        self._clock.resume()
        self.wall_s += wall_s() - self._since_wall_s
        return self._clock.machine_s() - self._began_s

    def _tell(self, tell: Callable[[Plugin], None]) -> None:
        for capability, plugin in each_plugin(self._plugins):
            try:
                tell(plugin)
            except Exception as error:  # the mission decides what it means
                self._on_error(capability, plugin, error)

    def as_report(self) -> PausesReport:
        """Return the figures of the report."""
        return PausesReport(self.count, round(self._clock.paused_s, 6), round(self.wall_s, 3))
