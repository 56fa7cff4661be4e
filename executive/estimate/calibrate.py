"""Calibration of a log's sensors: the run of a calibrator, its file and its report."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from executive.errors import ConfigError
from executive.estimate.estimator_run import prepare
from executive.estimate.material import Material
from executive.interfaces.calibration import Calibrator, Quantity
from executive.tree.choices import Choices

_DIGITS = 5
_NOISE = ("rate_hz", "gyro_noise_rad_s", "accel_noise_m_s2", "covariance_scale")


def calibrated(material: Material, name: str) -> Sequence[Quantity]:
    """Run a calibrator over a log.

    Raises:
        ConfigError: If there is no such calibrator.
        DataError: If the log shows no motion that could be solved for.
    """
    calibrator: Calibrator = prepare(material, "calibration", name, Choices(()))
    calibrator.start()
    try:
        return calibrator.calibrate(arrival.observation for arrival in material.arrivals)
    finally:
        calibrator.close()


def is_any_found(quantities: Sequence[Quantity]) -> bool:
    """Return whether a clock or a mounting was found; noise alone needs no motion."""
    return any(one.is_found.any() for one in quantities if one.name not in _NOISE)


def report(material: Material, name: str, quantities: Sequence[Quantity]) -> dict[str, Any]:
    """Return the figures, ready for JSON."""
    return {
        "log": str(material.log.path),
        "body": material.rig.name,
        "calibrator": name,
        "quantities": [
            {
                "sensor": one.sensor,
                "name": one.name,
                "value": _rounded(one.value),
                "std": _rounded(one.std),
                "declared": _rounded(one.declared),
                "found": one.is_found.tolist(),
                "advice": one.advice,
            }
            for one in quantities
        ],
    }


def lines(quantities: Sequence[Quantity]) -> Iterator[str]:
    """Yield a line for each quantity, for people."""
    for one in quantities:
        value = ", ".join(_pairs(one))
        missing = "" if one.is_found.all() else f"; not certain enough: needs {one.advice}"
        yield f"{one.sensor} {one.name}: {value}{missing}"


def write_calibration(path: Path, log: Path, quantities: Sequence[Quantity]) -> None:
    """Write what was found; a component that was not keeps what was declared.

    Raises:
        ConfigError: If the file cannot be written.
    """
    text = ["api: 1", f"log: {log.name!r}", "sensors:"]
    for sensor in dict.fromkeys(one.sensor for one in quantities):
        own = [one for one in quantities if one.sensor == sensor and one.is_found.any()]
        text += [f"  {sensor!r}:"] if own else []
        for one in own:
            text += [f"    {row}" for row in _rows(one)]
    try:
        path.write_text("\n".join(text) + "\n", encoding="utf-8")
    except OSError as error:
        raise ConfigError(f"{path} cannot be written: {error.strerror}") from error


def _rows(one: Quantity) -> Iterator[str]:
    values = _rounded(np.where(one.is_found, one.value, one.declared))
    written = values[0] if len(values) == 1 else f"[{', '.join(map(str, values))}]"
    yield f"{one.name}: {written}  # {', '.join(_pairs(one))}"
    if one.name == "stamp_late_s":
        yield f"stamp_std_s: {_rounded(one.std)[0]}"


def _pairs(one: Quantity) -> Iterator[str]:
    for value, std, is_found in zip(
        _rounded(one.value), _rounded(one.std), one.is_found, strict=True
    ):
        yield f"{value} ± {std}" + ("" if is_found else " (not found)")


def _rounded(values: Any) -> list[float]:
    return [float(f"{value:.{_DIGITS}g}") for value in np.atleast_1d(values)]
