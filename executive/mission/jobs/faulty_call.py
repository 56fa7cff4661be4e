"""A call of a verb that a fault on purpose makes fail, in whatever process it is computed."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from executive.faults.description import PluginFault
from executive.faults.injector import DELAY_S
from executive.faults.plugin_faults import misbehave
from executive.faults.tap import wrapped
from executive.interfaces.plugin import Plugin
from executive.mission.jobs.call import VerbCall


@dataclass(frozen=True, slots=True)
class DecidedCall(VerbCall):
    """A call of which has been decided whether it fails; the plugin decides no second time.

    Attributes:
        how: What the verb does instead of its work; empty if it works.
        sleeps_s: Of a late answer: time on the wall [s].
        charged_s: Of a late answer in lock-step: mission time [s].
    """

    how: str = ""
    sleeps_s: float = 0.0
    charged_s: float = 0.0

    def of(self, plugin: Plugin) -> Any:
        # The method of the class: one on the object would decide a second time.
        method = getattr(type(plugin), self.verb).__get__(plugin)
        return wrapped(plugin, self.verb, method, self._around)(*self.args, **self.kwargs)

    def _around(self, method: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        return misbehave(self.how, self.sleeps_s, lambda: method(*args, **kwargs))


def decided(call: VerbCall, fault: PluginFault | None, *, is_lock_step: bool) -> VerbCall:
    """Return the call with what a fault makes of it; in lock-step, late is mission time."""
    made = DecidedCall(call.verb, call.args, call.kwargs)
    if fault is None:
        return made
    delay_s = (fault.delay or DELAY_S) if fault.how == "late" else 0.0
    charged_s = delay_s if is_lock_step else 0.0
    return replace(made, how=fault.how, charged_s=charged_s, sleeps_s=delay_s - charged_s)
