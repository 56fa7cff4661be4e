"""The estimators that are laid side by side: those installed, and the peer."""

from collections.abc import Sequence
from typing import Any

from drawn_logs.drawn_log import DrawnLog
from drawn_logs.measuring import IMU
from drawn_logs.plain_smoother import PlainSmoother, PlainSmootherSettings
from executive import registry
from executive.estimate.drop import Drop
from executive.estimate.plugin_making import made
from executive.estimate.replay import Replay, Replayer
from executive.interfaces.estimation import Estimator
from executive.interfaces.recorded_log import RecordedBody

PEER = "plain_smoother"


def replayed(name: str, log: DrawnLog, drops: Sequence[Drop] = ()) -> tuple[Replay, str]:
    """Run an estimator, with the settings that `executive estimate` gives it.

    Returns:
        The states, and what the estimator said last of its status.
    """
    estimator = _peer(log) if name == PEER else _installed(name, log)
    estimator.start()
    try:
        replay = Replayer(estimator, IMU, drops).run(log.arrivals, None)
        account = estimator.account()
    finally:
        estimator.close()
    return replay, account[-1].reason if account else ""


def _peer(log: DrawnLog) -> Estimator:
    latitude_deg, longitude_deg, altitude_m = map(float, log.datum)
    settings = PlainSmootherSettings(datum=(latitude_deg, longitude_deg, altitude_m))
    return PlainSmoother(settings, log.rig)


def _installed(name: str, log: DrawnLog) -> Estimator:
    plugin: Any = registry.load("estimation", name)
    latitude_deg, longitude_deg, altitude_m = map(float, log.datum)
    datum = (latitude_deg, longitude_deg, altitude_m)
    asked_for = plugin.settings_for(RecordedBody((IMU,), datum, is_described=False))
    estimator: Estimator = made(plugin, plugin.Settings.model_validate(asked_for), log.rig)
    return estimator
