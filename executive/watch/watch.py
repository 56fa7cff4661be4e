"""Decides at each tick what the conditions of a mission ask for: go on, hold, fail, or stop."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

from executive.errors import ConfigError
from executive.events.event import Event
from executive.events.watch import ConditionBroken, ConditionRestored
from executive.machine.machine import Machine
from executive.watch.rules import Rule


class Wish(Enum):
    """What the watch asks of the mission."""

    GO_ON = "go_on"
    HOLD = "hold"
    FAIL = "fail"  # of what moves the machine
    STOP = "stop"


@dataclass(frozen=True, slots=True)
class Decision:
    """What the watch asks of the mission, for which condition, and why."""

    wish: Wish
    condition: str = ""
    reason: str = ""


@dataclass(slots=True)
class _Broken:
    since_s: float
    reason: str
    failed_s: float | None = None  # when it let the motion fail


class Watch:
    """The conditions of one mission; times are the machine's, which goes on in a hold.

    Args:
        machine: Whose sensors the conditions may name.
        rules: What happens, by condition; the rule of a sensor goes before that of its kind.
        record: Writes an event into the journal.
    """

    def __init__(
        self, machine: Machine, rules: Mapping[str, Rule], record: Callable[[Event], None]
    ) -> None:
        self._machine, self.rules, self._record = machine, rules, record
        self._broken: dict[str, _Broken] = {}
        self._held: tuple[str, float] | None = None  # condition, and since when
        self._well_since_s: float | None = None
        self._excused: set[str] = set()  # broken conditions whose wait is over: `then: go_on`
        self._failures: Counter[str] = Counter()  # motions that failed for a condition

    def rule_of(self, condition: str) -> Rule | None:
        """Return the rule of a condition, or None."""
        sensor = self._machine.sensors.get(condition)
        kind = sensor.kind if sensor is not None else condition
        return self.rules.get(condition) or self.rules.get(kind)

    def step(self, troubles: Mapping[str, str], now_s: float) -> Decision:
        """Take what is wrong now, by condition, and return what to do."""
        self._tell(troubles, now_s)
        acting = [c for c in self._broken if self._acts(c, now_s)]
        for condition in acting:
            if self._of(condition).do == "stop":
                return Decision(Wish.STOP, condition, self._broken[condition].reason)
        holding = [c for c in acting if self._of(c).do == "hold"]
        if self._held is not None:
            return self._hold(holding, now_s)
        if holding:
            self._held, self._well_since_s = (holding[0], now_s), None
            return Decision(Wish.HOLD, holding[0], self._broken[holding[0]].reason)
        decisions = [self._fail(condition, now_s) for condition in acting]
        return next((one for one in decisions if one.wish is not Wish.GO_ON), Decision(Wish.GO_ON))

    def broken(self) -> Mapping[str, str]:
        """Return what is wrong, by condition."""
        return {condition: one.reason for condition, one in self._broken.items()}

    def _tell(self, troubles: Mapping[str, str], now_s: float) -> None:
        for condition, reason in troubles.items():
            if condition not in self._broken:
                self._broken[condition] = _Broken(now_s, reason)
                self._record(ConditionBroken(condition, reason))
            self._broken[condition].reason = reason
        for condition in [one for one in self._broken if one not in troubles]:
            lasted_s = now_s - self._broken.pop(condition).since_s
            self._excused.discard(condition)
            self._record(ConditionRestored(condition, round(lasted_s, 6)))

    def _acts(self, condition: str, now_s: float) -> bool:
        rule = self.rule_of(condition)
        if rule is None or rule.do == "tell" or condition in self._excused:
            return False
        return now_s - self._broken[condition].since_s >= rule.after_s(self._machine) - 1e-9

    def _of(self, condition: str) -> Rule:
        rule = self.rule_of(condition)
        if rule is None:
            raise ConfigError(f"no rule for '{condition}'")
        return rule

    def _fail(self, condition: str, now_s: float) -> Decision:
        """Let the motion fail, once each time that the condition is broken, and not too often."""
        rule, broken = self._of(condition), self._broken[condition]
        if broken.failed_s is None and self._failures[condition] < rule.most:
            self._failures[condition] += 1
            broken.failed_s = now_s
            return Decision(Wish.FAIL, condition, broken.reason)
        if broken.failed_s is None:
            told = f"{broken.reason}; motions have failed for that {rule.most} times before"
        elif now_s - broken.failed_s >= rule.wait - 1e-9:
            told = f"{broken.reason}, {rule.wait:g} s after its rule has acted"
        else:
            return Decision(Wish.GO_ON)
        return Decision(Wish.STOP, condition, told)

    def _hold(self, acting: list[str], now_s: float) -> Decision:
        """Go on with a hold: until all is well for long enough, or the wait is over."""
        if self._held is None:
            return Decision(Wish.GO_ON)
        condition, since_s = self._held
        rule = self._of(acting[0] if acting else condition)
        waits = [c for c in self._broken if self._holds(c)]
        if not waits:
            self._well_since_s = now_s if self._well_since_s is None else self._well_since_s
            if now_s - self._well_since_s < rule.settle - 1e-9:
                return Decision(Wish.HOLD, condition)
            self._held = None
            return Decision(Wish.GO_ON, condition, f"{condition} is well again")
        self._well_since_s = None
        if now_s - since_s < rule.wait - 1e-9:
            return Decision(Wish.HOLD, condition, self._broken[waits[0]].reason)
        told = f"{self._broken[waits[0]].reason}; waited for {rule.wait:g} s"
        if rule.then == "stop":
            return Decision(Wish.STOP, waits[0], told)
        self._excused.update(waits)
        self._held = None
        return Decision(Wish.GO_ON, waits[0], told)

    def _holds(self, condition: str) -> bool:
        """Return whether a broken condition keeps a hold from ending, acting or not yet."""
        rule = self.rule_of(condition)
        waits = rule is not None and rule.do in ("hold", "stop")
        return waits and condition not in self._excused
