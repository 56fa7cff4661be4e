"""A machine in another process, real or simulated, that speaks the robot wire."""

import math
import time
from collections.abc import Mapping, Sequence
from typing import Any, cast

from executive_plugins.robot.settings import WireSettings

from executive.errors import ConfigError, DataError, RobotError
from executive.interfaces.facilities import SurveyedElsewhere
from executive.interfaces.robot import Robot
from executive.messages.cloud import Cloud
from executive.messages.command import Command
from executive.messages.observation import Observation
from executive.wire.address import Address
from executive.wire.connection import Connection
from executive.wire.frame import Frame, Kind, WireError
from executive.wire.payload import pack, unpack
from executive.wire.read_ahead import ReadAheadConnection
from executive.wire.survey import cloud_of

_ON_THE_WAY_S = 0.02  # two periods of the fastest sensors, in which nothing may arrive
_LOOK_S = 1.0  # between two looks whether a survey is still awaited


class WireRobot(Robot, SurveyedElsewhere):
    """Sends commands to a machine, and hears from it.

    Each `read` tells the machine that the executive is alive. As the driver of what lives by its
    own clock, it measures silence on the wall clock. Stamps are converted to the mission's
    time: at the first `read`, the machine's clock is taken to show that of the mission.

    Attributes:
        dropped: Observations that were measured before the mission began.
    """

    Settings = WireSettings
    has_own_clock = True

    def __init__(self, settings: WireSettings) -> None:
        self._settings = settings
        self._connection: Connection | None = None
        self._sequence = 0
        self._offset_s: float | None = None  # machine's clock at the mission's start
        self._has_read = False
        self._status: Mapping[str, Any] = {}  # the machine's newest, and when it arrived
        self._is_simulated = False
        self._heard_s = 0.0
        self._latched = ""
        self._stops_itself = True  # a stop that is latched was not asked for
        self._waiting: list[Frame] = []
        self.dropped = 0

    def start(self) -> None:
        """Connect with the machine.

        Raises:
            ConfigError: If nothing listens at the address.
            RobotError: If the machine refuses, such as one that another executive drives.
        """
        address = Address.parse(self._settings.address)
        try:
            found = address.connect(self._settings.answer_limit)
        except OSError as error:
            raise ConfigError(
                f"no machine listens at {address} ({error.strerror or error}); start one with "
                "'executive simulate', or correct robot.address"
            ) from error
        self._connection = ReadAheadConnection(found)
        try:
            hello = {"role": "executive", "model": self._settings.model}
            welcome = self._ask(Frame(Kind.HELLO, hello))
            self._status = welcome.head
            self.is_ideal = bool(welcome.head.get("is_ideal", False))
            self._is_simulated = bool(welcome.head.get("is_simulated", False))
            self.lacks = frozenset(map(str, welcome.head.get("lacks", ())))
            if self._settings.reset_at_start:
                self.reset()
        except RobotError:
            self.close()
            raise

    def close(self) -> None:
        """End the connection; the machine comes to rest by itself if it still moves."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def read(self, until_s: float) -> Sequence[Observation]:
        connection = self._open()
        if not self._has_read:  # the start of other plugins took some time
            self._heard_s = time.monotonic()
        connection.send(Frame(Kind.ALIVE))
        self._hear(0.0)
        observations: list[Observation] = []
        arrived, self._waiting = self._waiting, []
        if arrived and not self._has_read:  # the newest was measured just now
            self._has_read, newest = True, arrived[-1].head
            if self._offset_s is None:
                self._offset_s = float(newest.get("time_s", 0.0)) - until_s
        for frame in arrived:
            observations += self._observations(frame, self._offset_s or 0.0)
        if self._latched and self._stops_itself:
            raise RobotError(f"the machine stopped by itself: {self._latched}")
        silent_s = time.monotonic() - self._heard_s
        if not connection.is_open or silent_s > self._settings.silence_limit:
            raise RobotError(f"the machine has sent nothing for {silent_s:.2f} s")
        return sorted(observations, key=lambda one: one.stamp_s)

    def command(self, command: Command) -> None:
        objects, body = pack([command])
        self._ask(Frame(Kind.COMMAND, {"commands": objects}, body))

    def stop(self) -> None:
        self._ask(Frame(Kind.STOP))

    def resume(self) -> None:
        self._ask(Frame(Kind.RESUME))

    def safe_stop(self, reason: str) -> None:
        self._stops_itself = False
        self._ask(Frame(Kind.SAFE_STOP, {"reason": reason}))
        self._latched = self._latched or reason

    def reset(self) -> None:
        self._ask(Frame(Kind.RESET))
        self._latched, self._stops_itself = "", True
        for frame in self._waiting:  # they were sent before the machine took the reset
            frame.head["latched"] = ""

    def behind_s(self) -> float:
        return float(self._status.get("behind_s", 0.0))

    def latest_s(self) -> float:
        if not (self._is_simulated and self._has_read and self._offset_s is not None):
            return math.inf
        self._hear(0.0)
        newest = self._waiting[-1].head if self._waiting else self._status
        return float(newest.get("time_s", 0.0)) - self._offset_s + _ON_THE_WAY_S

    def zero_s(self) -> float:
        return self._offset_s or 0.0

    def keep(self) -> Mapping[str, object]:
        """Return what the machine's clock showed at the mission's start."""
        return {} if self._offset_s is None else {"zero_s": self._offset_s}

    def restore(self, kept: Mapping[str, object]) -> None:
        self._offset_s = cast(float, kept["zero_s"])

    def taken_up_s(self, cut_off_s: float) -> float:
        if self._offset_s is None:
            return cut_off_s
        since_s = time.monotonic() - self._heard_s
        clock_s = float(self._status.get("time_s", 0.0)) + since_s
        found_s = max(clock_s - self._offset_s, cut_off_s)  # a machine begun anew is younger
        self._offset_s = clock_s - found_s
        return found_s

    def survey_of_site(self, seed: int) -> Cloud:
        """Ask over a connection of its own, so that the machine's is free for the loop."""
        try:
            found = Address.parse(self._settings.address).connect(self._settings.answer_limit)
        except OSError as error:
            raise DataError(f"the machine that makes the survey is gone: {error}") from error
        connection = Connection(found)
        try:
            connection.send(Frame(Kind.SURVEY, {"seed": seed}, sequence=1))
            while connection.is_open:
                for answer in connection.receive(_LOOK_S):
                    if answer.kind is Kind.REFUSED:
                        raise DataError(f"no survey: {answer.head.get('reason', '')}")
                    return cloud_of(answer)
        except WireError as error:
            raise DataError(f"no survey: {error}") from error
        finally:
            connection.close()
        raise DataError("no survey: the machine that makes it has ended")

    def address(self) -> str:
        return self._settings.address

    def latched(self) -> str:
        return self._latched

    def paused(self, now_s: float) -> None:
        self._ask(Frame(Kind.PAUSED))

    def resumed(self, now_s: float) -> None:
        self._ask(Frame(Kind.RESUMED))

    def _open(self) -> Connection:
        if self._connection is None:
            raise RobotError("the machine is not connected: call start() first")
        return self._connection

    def _ask(self, frame: Frame) -> Frame:
        """Send a frame and return its answer; observations that come before it are kept.

        Raises:
            RobotError: If the machine refuses, or does not answer in time.
        """
        connection = self._open()
        self._sequence += 1
        connection.send(Frame(frame.kind, frame.head, frame.body, self._sequence))
        limit_s = time.monotonic() + self._settings.answer_limit
        while time.monotonic() < limit_s and connection.is_open:
            answer = self._hear(limit_s - time.monotonic())
            if answer is None:
                continue
            if answer.kind is Kind.REFUSED:
                raise RobotError(f"the machine refuses: {answer.head.get('reason', '')}")
            return answer
        limit = self._settings.answer_limit
        raise RobotError(f"the machine did not answer {frame.kind.name} within {limit:g} s")

    def _hear(self, wait_s: float) -> Frame | None:
        """Take what has arrived; return the answer to the newest question, if it is there."""
        answer = None
        for frame in self._open().receive(max(wait_s, 0.0)):
            self._heard_s = time.monotonic()
            if frame.kind is Kind.OBSERVATIONS:
                self._waiting.append(frame)
            elif frame.sequence == self._sequence or frame.kind is Kind.REFUSED:
                answer = frame
        return answer

    def _observations(self, frame: Frame, offset_s: float) -> list[Observation]:
        self._status = frame.head
        self._latched = str(frame.head.get("latched", ""))
        found = unpack(frame.head.get("observations"), frame.body, offset_s)
        kept = [one for one in found if one.stamp_s >= 0.0]
        self.dropped += len(found) - len(kept)
        return kept
