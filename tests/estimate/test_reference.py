"""The online estimate is compared with a smoothed trajectory at the stamps that both have."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from executive.errors import DataError
from executive.estimate import reference as module
from executive.estimate.measures import Track
from executive.estimate.reference import with_reference
from executive.messages.base_state import BaseState

MATERIAL = SimpleNamespace(
    arrivals=[SimpleNamespace(observation=name) for name in ("first", "second")],
    log=SimpleNamespace(path="site.mcap"),
    rig="the rig",
)


class Smoother:
    """Finds the states that it was made with."""

    def __init__(self, *states):
        self.told, self._states = [], states

    def start(self):
        self.told.append("start")

    def smooth(self, observations):
        self.told += list(observations)
        return self._states

    def close(self):
        self.told.append("close")


@dataclass(frozen=True)
class Estimated:
    report: dict
    track: Track
    replay: SimpleNamespace = field(default_factory=lambda: SimpleNamespace(fixes=("a fix",)))
    reference: Track | None = None


def state(stamp_s, x_m, yaw_rad=0.0):
    T = np.eye(4)
    T[:3, :3] = Rotation.from_euler("z", yaw_rad).as_matrix()
    T[0, 3] = x_m
    return BaseState(stamp_s, T, np.eye(4), np.eye(4), *np.zeros((2, 3)), np.eye(6), "GLOBAL")


def compare(monkeypatch, smoother, *ours):
    asked = []
    monkeypatch.setattr(module, "prepare", lambda *given: asked.append(given[:3]) or smoother)
    monkeypatch.setattr(module, "map_origin", lambda plugin, material: "the datum")

    def fix_errors(track, fixes, rig, datum, drops):
        asked.append((track.stamps_s.tolist(), fixes, rig, datum, drops))
        return SimpleNamespace(predicted_m=np.array([[3.0, 4.0, 0.0]]))

    monkeypatch.setattr(module, "fix_errors", fix_errors)
    found = with_reference(MATERIAL, Estimated({"old": 1}, Track.of(ours)), "batch")
    return found, asked


def test_errors_are_those_at_common_stamps(monkeypatch):
    smoother = Smoother(state(1.0, 10.0), state(2.0, 10.0, 0.5), state(3.0, 30.0, 0.5))
    ours = state(0.0, 99.0), state(0.5, 99.0), state(2.0, 13.0, 0.9), state(3.0, 29.0, 0.3)
    found, asked = compare(monkeypatch, smoother, *ours)
    assert smoother.told == ["start", "first", "second", "close"]
    assert asked[0] == (MATERIAL, "smoothing", "batch")
    assert asked[1] == ([1.0, 2.0, 3.0], ("a fix",), "the rig", "the datum", ())
    assert found.report["old"] == 1
    report = found.report["reference"]
    assert (report["smoother"], report["fixes_m"]["mean"]) == ("batch", 5.0)
    position, rotation = report["position_m"], report["rotation_rad"]
    assert (position["n"], position["mean"], position["max"]) == (2, 2.0, 3.0)  # 3 m and 1 m
    assert (rotation["n"], rotation["mean"], rotation["max"]) == (2, 0.3, 0.4)
    assert found.reference.stamps_s.tolist() == [1.0, 2.0, 3.0]


def test_a_smoother_that_finds_nothing_is_told_and_closed(monkeypatch):
    smoother = Smoother()
    with pytest.raises(DataError, match=r"site\.mcap: batch found no trajectory"):
        compare(monkeypatch, smoother, state(1.0, 0.0))
    assert smoother.told[-1] == "close"
