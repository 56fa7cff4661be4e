"""A machine's end of the robot wire: hosts a robot, and brings it to rest when nobody is heard."""

import logging
import select
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from executive.errors import RobotError
from executive.interfaces.robot import Robot
from executive.messages.cloud import Cloud
from executive.messages.joints import JointSample
from executive.messages.observation import Observation
from executive.wire.address import Address
from executive.wire.connection import Connection
from executive.wire.frame import Frame, Kind, WireError
from executive.wire.payload import pack, unpack
from executive.wire.survey import SurveyUnderWay

STEP_S = 0.01  # of the machine's clock: the period of its fastest sensors
STATUS_S = 0.02  # between two status frames: a supervisor sees a change within a tick
SLIP_S = 0.1  # a simulation that is later than that lets its clock go slower instead
_REST_SPEED = 0.02  # of any joint [rad/s] or [m/s]; a machine that is slower is at rest

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Simulation:
    """What a simulated machine has beside its robot.

    Its clock goes slower on a computer that is too slow for it, and the mission's waits for it.

    Attributes:
        survey: Takes the site as it is, and returns what makes a survey of it from a seed, in any
            thread; None if there is none.
        begins_s: The time that the machine's clock shows first [s].
        tend: Called each time that the clock has gone on.
    """

    survey: Callable[[int], Callable[[], Cloud]] | None = None
    begins_s: float = 0.0
    tend: Callable[["MachineServer"], None] = lambda server: None


class MachineServer:
    """Lets a robot live by its own clock, and connects executives and supervisors with it.

    One executive at a time drives the machine; any number of supervisors may stop it. An executive
    that is silent for longer than `silence_s`, or whose connection ends, is no longer there: the
    machine stops by itself, and takes no command that moves it until the stop is reset.

    Attributes:
        slipped_s: How much later the machine's clock is than the wall clock, because the
            simulation was too slow for this computer [s].
    """

    def __init__(
        self,
        robot: Robot,
        model: str,
        address: Address,
        silence_s: float,
        simulation: Simulation | None = None,
    ) -> None:
        """Listen; the machine's clock does not go before `run`.

        Args:
            robot: The machine.
            model: Its model, which an executive has to name.
            address: Where to listen.
            silence_s: After so long without a sign of the executive the machine stops [s].
            simulation: What a simulated machine has beside; None for a real one.

        Raises:
            ConfigError: If the address is in use or cannot be made.
        """
        self._robot = robot
        self._model = model
        self._silence_s = silence_s
        self._listening = address.listen()
        self.address = address if address.path else Address("", self._listening.getsockname()[1])
        self._executive: Connection | None = None
        self._heard_s = 0.0
        self._is_driven = False  # from the first sign of life on, silence counts
        self._guests: list[Connection] = []  # connected, of either role or none yet
        self._supervisors: list[Connection] = []
        self._simulation = simulation or Simulation()
        self._is_simulated = simulation is not None
        self._surveys: list[SurveyUnderWay] = []
        self._time_s = self._simulation.begins_s
        self._origin_s = time.monotonic() - self._time_s
        self._alone_since_s = time.monotonic()
        self._status_s = 0.0
        self._speed = 0.0
        self.slipped_s = 0.0
        self.is_ended = False

    def run(self) -> None:
        """Serve until `is_ended` is set, as a signal handler does."""
        self._origin_s = time.monotonic() - self._time_s
        self._alone_since_s = time.monotonic()
        try:
            while not self.is_ended:
                self._give_surveys()
                self._wait()
                self._accept()
                for one in list(self._guests):
                    self._listen(one)
                    self._notice_silence()
                    self._sweep()  # before the next: it may be the executive that takes over
                self._live()
        finally:
            for one in self._guests:
                one.close()
            self._listening.close()

    @property
    def time_s(self) -> float:
        """The machine's clock [s]."""
        return self._time_s

    @property
    def alone_s(self) -> float:
        """For how long no executive has been connected [s]."""
        return 0.0 if self._executive is not None else time.monotonic() - self._alone_since_s

    def _wait(self) -> None:
        due_s = self._origin_s + self._time_s + self.slipped_s + STEP_S - time.monotonic()
        waited = [self._listening.fileno(), *(one.fileno() for one in self._guests if one.is_open)]
        kept = [one.fileno() for one in self._guests if one.has_kept]
        select.select(waited, kept, [], min(max(due_s, 0.0), STEP_S))

    def _accept(self) -> None:
        try:
            self._guests.append(Connection(self._listening.accept()[0]))
        except BlockingIOError:
            return

    # --- the machine's own life

    def _live(self) -> None:
        """Advance the machine's clock to the present in steps; tell what it measured."""
        late_s = time.monotonic() - self._origin_s - self.slipped_s - self._time_s
        if late_s < STEP_S:
            return
        if late_s > SLIP_S:
            self.slipped_s += late_s - STEP_S
        self._time_s += STEP_S
        observations = self._robot.read(self._time_s)
        for one in observations:
            if isinstance(one, JointSample):
                self._speed = float(np.abs(one.velocity).max(initial=0.0))
        self._tell(observations)
        self._simulation.tend(self)

    def _tell(self, observations: Sequence[Observation]) -> None:
        if self._executive is not None and self._is_driven and not self._is_silent():
            objects, body = pack(observations)
            head = {**self._status(), "observations": objects}
            self._executive.post(Frame(Kind.OBSERVATIONS, head, body))
        if time.monotonic() - self._status_s >= STATUS_S:
            self._status_s = time.monotonic()
            for one in self._supervisors:
                one.post(Frame(Kind.STATUS, self._status()))

    def _status(self) -> dict[str, Any]:
        silent_s = time.monotonic() - self._heard_s if self._executive is not None else None
        return {
            "time_s": round(self._time_s, 6),
            "latched": self._robot.latched(),
            "at_rest": self._speed < _REST_SPEED,
            "speed": self._speed,
            "silent_s": silent_s,
            "slipped_s": self.slipped_s,
            "behind_s": self._robot.behind_s(),
        }

    def _notice_silence(self) -> None:
        if self._executive is None:
            return
        if not self._executive.is_open:
            self._stop_safely("the executive's connection ended")
        elif self._is_driven and self._is_silent():
            silent_s = time.monotonic() - self._heard_s
            self._stop_safely(f"the executive was silent for {silent_s:.2f} s")

    def _is_silent(self) -> bool:
        return time.monotonic() - self._heard_s > self._silence_s

    def _stop_safely(self, reason: str) -> None:
        if not self._robot.latched():
            self._robot.safe_stop(reason)
            _log.warning("safe stop: %s", reason)

    # --- what others ask

    def _listen(self, one: Connection) -> None:
        try:
            for frame in one.receive():
                if one is self._executive:
                    self._heard_s = time.monotonic()
                self._take(one, frame)
        except (WireError, RobotError) as error:
            one.post(Frame(Kind.REFUSED, {"reason": str(error)}))
            one.close()

    def _sweep(self) -> None:
        """Forget those whose connection has ended."""
        self._guests = [one for one in self._guests if one.is_open]
        self._supervisors = [one for one in self._supervisors if one.is_open]
        if self._executive is not None and not self._executive.is_open:
            self._executive, self._is_driven = None, False
            self._alone_since_s = time.monotonic()

    def _take(self, one: Connection, frame: Frame) -> None:
        if frame.kind is Kind.HELLO:
            self._greet(one, frame)
        elif frame.kind is Kind.SAFE_STOP and (one in self._supervisors or one is self._executive):
            self._stop_safely(str(frame.head.get("reason", "")) or "asked for")
            one.post(Frame(Kind.DONE, self._status(), sequence=frame.sequence))
        elif frame.kind is Kind.SURVEY:
            self._begin_survey(one, frame)
        elif one is self._executive:
            self._obey(one, frame)
        else:
            reason = f"{frame.kind.name} is for the executive; begin with HELLO and a role"
            one.post(Frame(Kind.REFUSED, {"reason": reason}, sequence=frame.sequence))

    def _greet(self, one: Connection, frame: Frame) -> None:
        role, model = frame.head.get("role"), frame.head.get("model")
        reason = ""
        if role not in ("executive", "supervisor"):
            reason = f"the role is executive or supervisor, not {role!r}"
        elif role == "executive" and self._executive not in (None, one):
            reason = "another executive drives the machine"
        elif role == "executive" and model != self._model:
            reason = f"this machine is a '{self._model}', and the mission is for a '{model}'"
        if reason:
            one.post(Frame(Kind.REFUSED, {"reason": reason}, sequence=frame.sequence))
            return
        if role == "executive":
            self._executive, self._heard_s = one, time.monotonic()
        else:
            self._supervisors.append(one)
        head = {
            **self._status(),
            "model": self._model,
            "silence_s": self._silence_s,
            "is_ideal": self._robot.is_ideal,
            "is_simulated": self._is_simulated,
            "lacks": sorted(self._robot.lacks),
        }
        one.post(Frame(Kind.WELCOME, head, sequence=frame.sequence))

    def _begin_survey(self, one: Connection, frame: Frame) -> None:
        seed = frame.head.get("seed")
        survey = self._simulation.survey
        if survey is None or not isinstance(seed, int) or seed < 0:
            reason = "the seed of a survey is a count" if survey else "it makes no survey"
            one.post(Frame(Kind.REFUSED, {"reason": reason}, sequence=frame.sequence))
            return
        self._surveys.append(SurveyUnderWay(survey(seed), one, frame.sequence))

    def _give_surveys(self) -> None:
        """Answer whose survey is done; a large answer leaves in parts."""
        for survey in list(self._surveys):
            answer = survey.answer()
            if answer is not None:
                self._surveys.remove(survey)
                survey.asked_by.post(answer)
        for one in self._guests:
            one.flush()

    def _obey(self, one: Connection, frame: Frame) -> None:
        self._is_driven = self._is_driven or frame.kind is not Kind.RESET
        answer = Frame(Kind.DONE, {}, sequence=frame.sequence)
        try:
            if frame.kind is Kind.ALIVE:
                return
            self._act(frame)
        except RobotError as error:
            answer = Frame(Kind.REFUSED, {"reason": str(error)}, sequence=frame.sequence)
        one.post(answer)

    def _act(self, frame: Frame) -> None:
        """Do what the executive asks.

        Raises:
            RobotError: If the machine refuses it.
        """
        robot, now_s = self._robot, self._time_s
        if frame.kind is Kind.COMMAND:
            for command in unpack(frame.head.get("commands"), frame.body):
                robot.command(command)
            return
        actions: Mapping[Kind, Callable[[], None]] = {
            Kind.STOP: robot.stop,
            Kind.RESUME: robot.resume,
            Kind.RESET: robot.reset,
            Kind.PAUSED: lambda: robot.paused(now_s),
            Kind.RESUMED: lambda: robot.resumed(now_s),
        }
        if frame.kind not in actions:
            raise RobotError(f"{frame.kind.name} is nothing that an executive sends")
        actions[frame.kind]()
