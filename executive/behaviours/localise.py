"""Wait until the machine's pose is known."""

from executive.events.site import Localised
from executive.interfaces.estimation import Estimator
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import succeeded


class Localise(Action):
    """Wait for a usable state estimate; bound it with a `timeout`."""

    needs = (Estimator,)
    on_resume = OnResume.REDO

    def run(self) -> Steps[None]:
        while not self.context.state().is_ready:
            yield None
        state = self.context.state()
        self.context.record(Localised(state.T_map_base, state.status))
        return succeeded()
