"""Generalised ICP (Segal 2009): each point carries the covariance of its neighbourhood."""

from executive_plugins.alignment.local_fit import compile_fit, fit
from executive_plugins.alignment.settings import GicpSettings

from executive.arrays import Float
from executive.interfaces.alignment import Aligner
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud


class Gicp(Aligner):
    """Generalised ICP in one thread."""

    Settings = GicpSettings
    latency_s = {"align": 0.1}
    is_stateless = True

    def __init__(self, settings: GicpSettings) -> None:
        self._settings = settings

    def start(self) -> None:
        """Compile the inner loops, so that no cloud has to wait for them."""
        compile_fit()

    def align(
        self, target: Cloud, source: Cloud, T_target_source: Float, max_distance_m: float
    ) -> Alignment:
        """Move the source onto the target from a guess; see `local_fit.fit`."""
        return fit("GICP", self._settings, target, source, T_target_source, max_distance_m)
