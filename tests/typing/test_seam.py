"""mypy refuses a misspelt verb, port or field between leaves, plugins, journal and report."""

import sys
from pathlib import Path

import pytest
from mypy import api

ROOT = Path(__file__).parents[2]
LEAF = """
from dataclasses import dataclass

from executive.events.site import SiteScanned
from executive.interfaces.motion import MotionPlanner
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.messages.trajectory import JointTrajectory


@dataclass(frozen=True, slots=True)
class SwingPlanned:
    trajectory: JointTrajectory


class PlanSwing(Action):
    needs = (MotionPlanner,)

    def run(self, angle: float) -> Steps[SwingPlanned]:
        motion = self.context.use(MotionPlanner)
        plan = yield from self.context.job(motion.swing, self.context.arm(), angle, 5.0)
        if plan.trajectory is None:
            return failed(plan.reason)
        self.context.record(SiteScanned(points=3))
        return succeeded(SwingPlanned(trajectory=plan.trajectory))
"""
MISTAKES = {
    "a misspelt verb": ("motion.swing,", "motion.swnig,", 'no attribute "swnig"'),
    "a misspelt verb at once": (
        "motion = self.context.use(MotionPlanner)",
        "motion = self.context.use(MotionPlanner)\n        motion.reech(self.context.gripper())",
        'no attribute "reech"',
    ),
    "an argument too few": ("angle, 5.0)", "angle)", 'Missing positional argument "duration_s"'),
    "an argument of another type": ("angle, 5.0)", 'angle, "5 s")', "incompatible type"),
    "a misspelt field of an answer": ("plan.reason", "plan.raeson", 'no attribute "raeson"'),
    "a misspelt output": ("trajectory=plan", "trajektory=plan", "Unexpected keyword argument"),
    "an output of another type": ("=plan.trajectory))", "=plan.reason))", "incompatible type"),
    "a misspelt field of an event": ("points=3", "point=3", "Unexpected keyword argument"),
    "a setting that does not exist": ("angle, 5.0", "angle, self.settings.slow", "no attribute"),
}


METRIC = """
from executive.interfaces.metric import Metric, RunRecord, Values


class Slips(Metric):
    title = "slips by the stones of the site"

    def measure(self, run: RunRecord) -> Values | None:
        truth = run.report.truth
        if truth is None or not truth.objects:
            return None
        return Values((run.report.counts.slips / truth.objects.stones,))
"""
MISREADINGS = {
    "a misspelt field of the report": ("report.truth", "report.thruth", 'no attribute "thruth"'),
    "a misspelt count": ("counts.slips", "counts.slip", 'has no attribute "slip"'),
    "a misspelt field of the truth": ("objects.stones", "objects.stone", "has no attribute"),
    "a truth that may be absent": ("truth is None or not", "not", 'of "Truth | None" has no'),
    "a part of the truth that may be empty": (" or not truth.objects", "", 'Item "Nothing" of'),
    "a field by its name in the file": ("counts.slips", 'counts["slips"]', "not indexable"),
}


def checked(folder: Path, text: str) -> str:
    """Return what `mypy --strict` says of a module of a package that uses the executive."""
    path = folder / "leaf.py"
    path.write_text(text, encoding="utf-8")
    cache = ROOT / ".mypy_cache" / "seam"
    words = ["--strict", "--config-file", "", "--cache-dir", str(cache), "--follow-imports=silent"]
    said, errors, _ = api.run([*words, "--ignore-missing-imports", str(path)])
    assert not errors
    return said


@pytest.fixture(scope="module", autouse=True)
def paths() -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MYPYPATH", str(ROOT))
        patch.syspath_prepend(str(ROOT))
        yield


@pytest.mark.slow
def test_mypy_takes_a_leaf_without_a_mistake(tmp_path: Path) -> None:
    assert checked(tmp_path, LEAF).startswith("Success"), sys.version


@pytest.mark.slow
@pytest.mark.parametrize("mistake", MISTAKES.values(), ids=list(MISTAKES))
def test_mypy_refuses(tmp_path: Path, mistake: tuple[str, str, str]) -> None:
    right, wrong, words = mistake
    assert right in LEAF
    said = checked(tmp_path, LEAF.replace(right, wrong))
    assert "leaf.py" in said
    assert words in said


@pytest.mark.slow
def test_mypy_takes_a_metric_without_a_mistake(tmp_path: Path) -> None:
    assert checked(tmp_path, METRIC).startswith("Success"), sys.version


@pytest.mark.slow
@pytest.mark.parametrize("mistake", MISREADINGS.values(), ids=list(MISREADINGS))
def test_mypy_refuses_in_a_metric(tmp_path: Path, mistake: tuple[str, str, str]) -> None:
    right, wrong, words = mistake
    assert right in METRIC
    said = checked(tmp_path, METRIC.replace(right, wrong))
    assert "leaf.py" in said
    assert words in said
