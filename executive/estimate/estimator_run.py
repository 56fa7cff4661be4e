"""One estimator run on one log, and the report of the run."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.clock import WallClock
from executive.errors import ConfigError, DataError
from executive.estimate.material import Material
from executive.estimate.measures import (
    FixErrors,
    Track,
    consistency,
    fix_errors,
    outages,
    spread,
    statistics,
)
from executive.estimate.options import EstimateOptions
from executive.estimate.plugin_making import made
from executive.estimate.replay import Replay, Replayer
from executive.interfaces.estimation import Estimator
from executive.interfaces.recorded_log import LogPlugin
from executive.tree.choices import Choices


@dataclass(frozen=True, slots=True, eq=False)
class Estimated:
    """The result of one estimator on one log.

    Attributes:
        report: The figures, ready for JSON.
        replay: The states and what was counted on the way.
        track: The states as arrays.
        errors: The states against the fixes.
        reference: The trajectory that a smoother found; None if none was run.
    """

    report: dict[str, Any]
    replay: Replay
    track: Track
    errors: FixErrors
    reference: Track | None = None


def prepare(material: Material, capability: str, name: str, plugins: Choices) -> Any:
    """Return a plugin, not yet started, with the settings that a log asks for.

    Args:
        material: The log.
        capability: `estimation` or `smoothing`.
        name: Name of the plugin.
        plugins: Its settings, which take precedence over what the log asks for.

    Raises:
        ConfigError: If there is no such plugin, or its settings are wrong.
        DataError: If the log has no inertial sample.
    """
    plugin = plugins.plugin(capability, name)
    if not issubclass(plugin, LogPlugin):
        raise ConfigError(f"{capability} plugin '{name}' does not run on recorded logs")
    asked_for = plugin.settings_for(material.body())
    settings = plugins.selection(capability, name, lambda _: asked_for).settings
    return made(plugin, settings, material.rig)


def map_origin(plugin: LogPlugin, material: Material) -> Float:
    """Return the origin of a plugin's map: latitude, longitude [deg], altitude [m], shape (3,)."""
    return material.datum if plugin.datum is None else np.array(plugin.datum)


def estimate(material: Material, name: str, options: EstimateOptions) -> Estimated:
    """Run an estimator over a log.

    Raises:
        ConfigError: If there is no such estimator, or its settings are wrong.
        DataError: If the estimator never found a first state.
    """
    estimator: Estimator = prepare(material, "estimation", name, options.plugins)
    imu = estimator.imu or material.body().imus[0]
    try:
        estimator.start()
        replayer = Replayer(estimator, imu, material.drops)
        replay = replayer.run(material.arrivals, WallClock() if options.is_realtime else None)
    finally:
        estimator.close()
    if not replay.states:
        raise DataError(_no_state(material, name, estimator, replay))
    track, datum = Track.of(replay.states), map_origin(estimator, material)
    # Without a heading a correction turns the whole path; figures are of the states with one.
    ready = Track.of([state for state in replay.states if state.is_ready] or replay.states)
    errors = fix_errors(ready, replay.fixes, material.rig, datum, material.drops)
    return Estimated(_report(material, name, replay, ready, errors), replay, track, errors)


def _no_state(material: Material, name: str, estimator: Estimator, replay: Replay) -> str:
    refused = ", ".join(f"{reason} ×{n}" for reason, n in replay.refused.items()) or "nothing"
    changes = estimator.account()
    last = f"At {changes[-1].stamp_s:.1f} s it {changes[-1].reason}. " if changes else ""
    return (
        f"{material.log.path}: {name} found no first state. It needs fixes, and a rest of some "
        "seconds with two antennas or motion that tells the heading. "
        f"{last}Refused: {refused}"
    )


def _report(
    material: Material, name: str, replay: Replay, track: Track, errors: FixErrors
) -> dict[str, Any]:
    used = ~errors.is_dropped
    duration_s = material.arrivals[-1].arrival_s
    return {
        "log": str(material.log.path),
        "body": material.rig.name,
        "estimator": name,
        "duration_s": round(duration_s, 3),
        "replay_speed": round(duration_s / replay.wall_s, 1),
        "counts": dict(replay.counts),
        "cut": asdict(material.log.cut) if material.log.cut else None,
        "skipped": {topic: asdict(skipped) for topic, skipped in material.log.skipped.items()},
        "refused": replay.refused,
        "states": [
            {"time_s": round(at_s, 3), "status": status, "reason": reason}
            for at_s, status, reason in replay.changes
        ],
        "latency_us": statistics(np.array(replay.latency_us), 1),
        "consistency_m": statistics(consistency(track)),
        "prediction_m": spread(errors.predicted_m[used]),
        "posterior_m": spread(errors.posterior_m[used]),
        "outages": outages(errors, material.drops),
    }
