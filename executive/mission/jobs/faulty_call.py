"""A call of a verb that a fault on purpose makes fail, in whatever process it is computed."""

from dataclasses import dataclass, replace
from typing import Any

from executive.faults.description import PluginFault
from executive.faults.injector import DELAY_S
from executive.faults.plugin_faults import misbehave
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
        return misbehave(self.how, self.sleeps_s, lambda: self._past_the_tap(plugin))

    def _past_the_tap(self, plugin: Plugin) -> Any:
        """Call the method of the class, not the replacement that decides on direct calls."""
        return getattr(type(plugin), self.verb)(plugin, *self.args, **self.kwargs)


def decided(call: VerbCall, fault: PluginFault | None, *, is_lock_step: bool) -> VerbCall:
    """Return the call with what a fault makes of it; in lock-step, late is mission time."""
    made = DecidedCall(call.verb, call.args, call.kwargs)
    if fault is None:
        return made
    delay_s = (fault.delay or DELAY_S) if fault.how == "late" else 0.0
    charged_s = delay_s if is_lock_step else 0.0
    return replace(made, how=fault.how, charged_s=charged_s, sleeps_s=delay_s - charged_s)
