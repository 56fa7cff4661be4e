"""Each fault that the kit is for is caught, by the check that is named for it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from executive.errors import ConfigError
from executive.testing.finding import Finding, Outcome
from executive.testing.run import Trial, hold_to_contract

HEAD = """
import itertools
import numpy as np
from pydantic import BaseModel, Field
from executive.config import Settings
from executive.errors import DataError
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation

class MineSettings(Settings):
    margin_m: float = Field(0.1, gt=0, description="Height of the ground [m].")

class Sound(Segmenter):
    'Takes every point for ground.'
    Settings = MineSettings
    is_stateless = True
    def __init__(self, settings: MineSettings) -> None:
        self._settings = settings
    def segment(self, cloud: Cloud) -> Segmentation:
        if not len(cloud):
            raise DataError("an empty cloud has no ground")
        plane = np.array([0.0, 0.0, 1.0, float(np.median(cloud.points[:, 2]))])
        return Segmentation(cloud.frame, (), cloud, plane)
    def merge(self, clouds):
        frames = sorted({cloud.frame for cloud in clouds})
        if len(frames) != 1:
            raise DataError(f"expected one frame: {', '.join(frames) or 'no cloud'}")
        points = np.unique(np.vstack([cloud.points for cloud in clouds]).round(2), axis=0)
        return Cloud(frames[0], points)
"""

# The fault, and the check that must catch it.
FAULTS = {
    "writes to its input": (
        """
class Mine(Sound):
    "Moves the cloud to its ground, in place."
    def segment(self, cloud):
        cloud.points[:, 2] -= 0.1
        return super().segment(cloud)
""",
        "it answers",
        "read-only",
    ),
    "unlocks its input and writes to it": (
        """
class Mine(Sound):
    "Moves the cloud to its ground, in place, whatever the lock says."
    def segment(self, cloud):
        if len(cloud):
            cloud.points.base[:, 2] -= 0.1
        return super().segment(cloud)
""",
        "its inputs stay as they were",
        "cloud",
    ),
    "draws from a generator of its own": (
        """
class Mine(Sound):
    "Jitters the ground by chance of its own."
    def segment(self, cloud):
        found = super().segment(cloud)
        shift = np.random.default_rng().normal(0, 0.01)
        return Segmentation(found.frame, (), found.ground, found.ground_plane + [0, 0, 0, shift])
""",
        "it gives the same bytes twice",
        "ground_plane",
    ),
    "counts its calls and says that it is stateless": (
        """
STARTED = itertools.count()
class Mine(Sound):
    "Remembers how many there were before it, in this process."
    def __init__(self, settings):
        super().__init__(settings)
        self._number = min(next(STARTED), 1)
    def segment(self, cloud):
        found = super().segment(cloud)
        plane = found.ground_plane + [0, 0, 0, self._number]
        return Segmentation(found.frame, (), found.ground, plane)
""",
        "a spawned process gives the same answer",
        "is_stateless",
    ),
    "falls over an empty cloud": (
        """
class Mine(Sound):
    "Does not look whether there is a cloud."
    def segment(self, cloud):
        lowest = cloud.points[:, 2].min()
        return super().segment(cloud)
""",
        "a hostile input gives a value or a refusal [an empty cloud]",
        "ValueError",
    ),
    "has settings without a description": (
        """
class LooseSettings(Settings):
    margin_m: float = Field(0.1, gt=0)
class Mine(Sound):
    "Does not say what its setting is."
    Settings = LooseSettings
""",
        "each setting is described",
        "margin_m",
    ),
    "has a number without a bound": (
        """
class LooseSettings(Settings):
    margin_m: float = Field(0.1, description="Height of the ground [m].")
class Mine(Sound):
    "Takes any number."
    Settings = LooseSettings
""",
        "each number has a bound",
        "margin_m",
    ),
    "takes settings that it does not know": (
        """
class LooseSettings(BaseModel):
    margin_m: float = Field(0.1, gt=0, description="Height of the ground [m].")
class Mine(Sound):
    "Has settings of another kind."
    Settings = LooseSettings
""",
        "its settings are a settings class",
        "executive.config.Settings",
    ),
    "lacks a verb": (
        """
class Mine(Segmenter):
    "Is not finished."
    def segment(self, cloud):
        return None
""",
        "it implements every verb",
        "merge",
    ),
    "takes another argument": (
        """
class Mine(Sound):
    "Wants to know more than the interface gives."
    def segment(self, cloud, margin_m):
        return super().segment(cloud)
""",
        "its verbs take what the interface says",
        "margin_m",
    ),
    "is too slow": (
        """
import time
class Mine(Sound):
    "Sleeps."
    def segment(self, cloud):
        time.sleep(0.6)
        return super().segment(cloud)
""",
        "its verbs end in time",
        "segment took 0.6 s",
    ),
    "cannot be closed twice": (
        """
class Mine(Sound):
    "Lets its file go, and then again."
    def start(self):
        self._files = ["one"]
    def close(self):
        self._files.pop()
""",
        "it can be closed twice",
        "IndexError",
    ),
    "declares the latency of another verb": (
        """
class Mine(Sound):
    "Names a verb that there is not."
    latency_s = {"segmentate": 0.1}
""",
        "its declared latencies are those of its verbs",
        "segmentate",
    ),
}

Held = Callable[..., tuple[Finding, ...]]


@pytest.fixture
def held(install: Callable[..., Path]) -> Held:
    """Install a module with a class `Mine`, and hold it to the contract of segmentation."""

    def hold(source: str, **options: float) -> tuple[Finding, ...]:
        install("mine", {"mine.py": HEAD + source}, {"segmentation": {"mine": "mine:Mine"}})
        return hold_to_contract(Trial("segmentation", "mine", **options))

    return hold


def test_a_sound_plugin_passes(held: Held) -> None:
    findings = held("Mine = Sound")
    assert [one.line() for one in findings if one.outcome is Outcome.FAIL] == []
    assert [one for one in findings if one.outcome is Outcome.SKIP]


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_plugin_is_caught_by_name(held: Held, fault: str) -> None:
    source, check, reason = FAULTS[fault]
    failed = {one.check: one for one in held(source, time_limit_s=0.5) if one.outcome == "fail"}
    assert check in failed, f"caught by {sorted(failed)}"
    assert reason in failed[check].reason
    assert "mine.py:" in failed[check].place


def test_the_place_is_the_line_of_the_plugin(held: Held) -> None:
    source, check, _ = FAULTS["falls over an empty cloud"]
    (found,) = [one for one in held(source) if one.check == check]
    lines = (HEAD + source).splitlines()
    assert "min()" in lines[int(found.place.rpartition(":")[2]) - 1]


def test_a_plugin_that_refuses_is_skipped_unless_it_must_succeed(held: Held) -> None:
    check = "it finds boulders and ground in the clouds own frame"
    (skipped,) = [one for one in held("Mine = Sound") if one.check == check]
    assert skipped.outcome is Outcome.SKIP
    assert "three boulders" in skipped.reason
    again = hold_to_contract(Trial("segmentation", "mine", must_succeed=True))
    assert [one.outcome for one in again if one.check == check] == ["fail"]


def test_an_unknown_capability_and_an_unknown_plugin_are_refused() -> None:
    with pytest.raises(ConfigError, match="Did you mean 'segmentation'"):
        hold_to_contract(Trial("segmentatoin", "ground_and_clusters"))
    with pytest.raises(ConfigError, match="ground_and_clusters"):
        hold_to_contract(Trial("segmentation", "ground_and_cluster"))


FAULTY_LEAF = '''
from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, succeeded


class Mine(Condition):
    """Reads the machine's name too early, and does not say what its port is."""

    def __init__(self, settings, context):
        super().__init__(settings, context)
        self._name = context.machine().name

    def check(self, stone: int) -> Outcome[None]:
        """Succeed."""
        return succeeded()
'''


def test_a_faulty_leaf_is_caught_by_name(install: Callable[..., Path]) -> None:
    install("faulty", {"faulty.py": FAULTY_LEAF}, {"behaviour": {"Mine": "faulty:Mine"}})
    findings = hold_to_contract(Trial("leaf", "Mine"))
    failed = {one.check: one for one in findings if one.outcome == "fail"}
    assert sorted(failed) == ["each port is described", "it is made without a mission"]
    assert "stone" in failed["each port is described"].reason
    assert "faulty.py:" in failed["it is made without a mission"].place
