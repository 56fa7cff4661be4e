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
from executive.logs.log import Arrival

PEER = "plain_smoother"


class Run:
    """An estimator on a log, with the settings that `executive estimate` gives it."""

    def __init__(self, name: str, log: DrawnLog, drops: Sequence[Drop] = ()) -> None:
        self._estimator = _peer(log) if name == PEER else _installed(name, log)
        self._estimator.start()
        self._replayer = Replayer(self._estimator, IMU, drops)

    def feed(self, arrivals: Sequence[Arrival]) -> Replay:
        """Feed the next measurements; return the states from the first one on."""
        return self._replayer.run(arrivals, None)

    def close(self) -> str:
        """End it, and return what it said last of its status."""
        account = self._estimator.account()
        self._estimator.close()
        return account[-1].reason if account else ""


def preload(names: Sequence[str]) -> None:
    """Import estimators, so that processes that are forked from this one need not."""
    for name in names:
        if name != PEER:
            registry.load("estimation", name)


def replayed(name: str, log: DrawnLog, drops: Sequence[Drop] = ()) -> tuple[Replay, str]:
    """Run an estimator on a whole log.

    Returns:
        The states, and what the estimator said last of its status.
    """
    run = Run(name, log, drops)
    try:
        replay = run.feed(log.arrivals)
    finally:
        said = run.close()
    return replay, said


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
