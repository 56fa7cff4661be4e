"""Wait until the machine knows where it is."""

from typing import Any

from executive.leaf.action import Action, Steps
from executive.leaf.outcome import succeeded


class Localise(Action):
    """Wait for a usable state estimate; bound it with a `timeout`."""

    needs = ("estimation",)

    def run(self, **inputs: Any) -> Steps:
        while not self.context.state().is_ready:
            yield None
        state = self.context.state()
        self.context.note("localised", T_map_base=state.T_map_base, status=state.status)
        return succeeded()
