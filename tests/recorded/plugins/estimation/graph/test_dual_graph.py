"""The dual graph over streams with faults."""

import pytest
from executive_plugins.estimation.graph.dual_graph import DualGraph
from executive_plugins.estimation.graph.settings import DualGraphSettings

SMOOTHER = {
    "lag_s": 0.6,
    "gate": {"window_s": 1.0, "recover_after_s": 0.3, "reanchor_after_s": 0.8},
    "suspect_after_s": 0.3,
    "fallback_after_s": 0.5,
    "node_after_s": 0.3,
}


def settings(fallback: str) -> DualGraphSettings:
    return DualGraphSettings(
        rest={"duration_s": 0.5},
        smoother={**SMOOTHER, "fallback": fallback},
        restart_after_s=1.0,
    )


FAULTS = (
    "fixes far off",
    "fixes that drift",
    "no fixes",
    "late fixes",
    "a short gap",
    "a long gap",
    "a moving chassis",
    "increments with a gap",
)


@pytest.mark.parametrize("faulty", FAULTS, indirect=True)
def test_relative(recorded, machine, faulty, followed) -> None:
    # The values are decided by an iteration that stops below a tolerance of its own.
    recorded(followed(DualGraph(settings("relative"), machine), faulty), relative=1e-4)


@pytest.mark.parametrize("faulty", ["fixes far off", "no fixes", "a long gap"], indirect=True)
def test_pseudo_global(recorded, machine, faulty, followed) -> None:
    recorded(followed(DualGraph(settings("pseudo_global"), machine), faulty), relative=1e-6)
