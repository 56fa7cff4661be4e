"""The hydraulics of a machine: which figures are taken, and which are refused."""

import pytest
from pydantic import ValidationError

from executive.machine.hydraulics import Hydraulics

USUAL = {
    "dead_time_s": 0.15,
    "lag_hz": 1.0,
    "dead_band": 0.08,
    "spread": 0.15,
    "valve_margin": 1.25,
    "pump_flow_m3_s": 0.005,
    "displacement": {"J_BOOM": 0.0092},
    "friction": 0.01,
    "angle_step_rad": 3.8e-4,
    "length_step_m": 0.0005,
    "provenance": "guess",
}


@pytest.mark.parametrize(
    ("name", "good", "bad"),
    [
        ("dead_time_s", (0.01, 0.5), (0.009, 0.51)),
        ("lag_hz", (0.1, 20.0), (0.0, 20.1)),
        ("dead_band", (0.0, 0.49), (-0.01, 0.5)),
        ("spread", (0.0, 0.49), (-0.01, 0.5)),
        ("valve_margin", (1.0, 3.0), (0.99, 3.1)),
        ("pump_flow_m3_s", (1e-4,), (0.0,)),
        ("friction", (0.0, 0.19), (-0.01, 0.2)),
        ("angle_step_rad", (0.0, 1e-3), (-1e-3,)),
        ("length_step_m", (0.0, 1e-3), (-1e-3,)),
    ],
)
def test_figures_have_bounds(name: str, good: tuple, bad: tuple) -> None:
    for value in good:
        assert getattr(Hydraulics(**{**USUAL, name: value}), name) == value
    for value in bad:
        with pytest.raises(ValidationError, match=name):
            Hydraulics(**{**USUAL, name: value})


@pytest.mark.parametrize("name", USUAL)
def test_no_figure_is_assumed(name: str) -> None:
    with pytest.raises(ValidationError, match="Field required"):
        Hydraulics(**{key: value for key, value in USUAL.items() if key != name})
