"""Packages of `plugins new` in an environment of their own: written, installed, tested, used."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from bounds import Bound, Figure, held, judged

from executive import registry
from executive.events.node import LeafAnswered, NodeTimedOut
from executive.journal.reading import read_journal
from executive.leaf.map_file import MapFile, write_map
from executive.messages.cloud import Cloud
from executive.testing.new_package import LEAF

HERE = Path(__file__).parent
ROOT = HERE.parents[2]
MISSIONS = ("new_packages", "new_robot")
KINDS = (*registry.capabilities(), registry.SMOOTHERS, LEAF)
FOREIGN = ("plugins", "trees", "robot_models")
LEAST_CHECKS = 7  # that every plugin passes, whatever its capability
LIMIT_S = 1800.0  # of one command; installing is the longest
# What the nodes of a mission answer: a method that is not written yet is a failure with its reason.
TOLD = {
    "leaf": ("FreshLeaf", ""),
    "estimation": ("Localise", "took longer than 2 s"),
    "surveying": ("SurveySite", "fresh_surveying has no survey yet"),
    "registration": ("RegisterDroneMap", "registration refused: the method is not written yet"),
    "segmentation, mapping": ("Segment", "2 stones"),
    "placing": ("FindSlots", "there is free ground for 0 stones"),
    "objects": ("SelectLargest", "stone "),
    "grasping": ("PlanGrasp", "no grasp of stone 1: 1 not_written_yet"),
    "motion": ("GoToPosture", "no way there: FreshMotion plans no motion"),
}


class UserFailedError(Exception):
    """A command that a user has to give ended badly."""


@dataclass(frozen=True)
class User:
    """Somebody with an empty folder and a virtual environment: what they type, and where."""

    folder: Path

    @property
    def binaries(self) -> Path:
        """The folder of the environment's commands."""
        return self.folder / "env" / "bin"

    def run(self, *words: str | Path, may_fail: bool = False) -> subprocess.CompletedProcess[str]:
        """Run one command with foreign packages on the path.

        Raises:
            UserFailedError: If it ends badly and may not.
        """
        command = [str(word) for word in words]
        if (self.binaries / command[0]).exists():
            command[0] = str(self.binaries / command[0])
        done = subprocess.run(
            command,
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": str(self.folder / "foreign")},
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
        if done.returncode and not may_fail:
            raise UserFailedError(f"{' '.join(command)}: {done.stderr[-2000:]}")
        return done


def measured(folder: Path | None) -> list[Figure]:
    """Do all that a user does, and return what came of it.

    Args:
        folder: A new folder that is kept; None for one that is removed.
    """
    with nullcontext(folder) if folder else TemporaryDirectory() as name:
        user = User(Path(name).resolve())
        user.folder.mkdir(parents=True, exist_ok=True)
        set_up(user)
        rows = [figure for kind in KINDS for figure in package(user, kind)]
        return [*rows, *missions(user), *foreign_packages(user)]


def set_up(user: User) -> None:
    """Clone, build the wheel, install it, and put foreign packages on the path."""
    for name in FOREIGN:
        (user.folder / "foreign" / name).mkdir(parents=True)
        init = user.folder / "foreign" / name / "__init__.py"
        init.write_text("raise RuntimeError('a foreign package was imported')\n")
    user.run("git", "clone", "--quiet", "--depth", "1", ROOT.as_uri(), "clone")
    user.run(sys.executable, "-m", "venv", "env")
    user.run("pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", "dist", "./clone")
    (wheel,) = (user.folder / "dist").glob("*.whl")
    _say(f"installing {wheel.name}")
    user.run("pip", "install", "--quiet", f"{wheel}[testing]")


def package(user: User, kind: str) -> Iterator[Figure]:
    """Write, install and test the package of one capability."""
    name = f"fresh_{kind}"
    user.run("executive", "plugins", "new", kind, name)
    user.run("pip", "install", "--quiet", f"./{name}")
    announced = "FreshLeaf" if kind == LEAF else name
    done = user.run("executive", "plugins", "test", kind, announced, "--json", may_fail=True)
    try:
        outcomes = [check["outcome"] for check in json.loads(done.stdout)["checks"]]
    except ValueError:
        _say(done.stderr)
        outcomes = ["fail"]
    passed, failed = outcomes.count("pass"), outcomes.count("fail")
    _say(f"{kind}: {passed} checks passed, {failed} failed")
    yield held(f"{kind}: checks failed", failed, Bound(0))
    yield held(f"{kind}: checks passed", passed, Bound(LEAST_CHECKS, is_least=True))


def missions(user: User) -> Iterator[Figure]:
    """Run the missions, and look at what the leaves of the first say of each package."""
    _write_site(user.folder / "site.ply")
    for name in MISSIONS:
        text = (HERE / f"{name}.yaml").read_text(encoding="utf-8")
        (user.folder / f"{name}.yaml").write_text(text, encoding="utf-8")
        done = user.run("executive", "run", f"{name}.yaml", "--run-dir", name, may_fail=True)
        _say(done.stderr)
        ended = f"{_outcome(user.folder / name)}, status {done.returncode}"
        wanted = "success, status 0"
        yield judged(f"the end of {name}.yaml", ended, wanted, ended == wanted)
    answers = _answers(user.folder / MISSIONS[0])
    for kind, (leaf, words) in TOLD.items():
        answer = answers.get(leaf, "it was not asked")
        yield judged(f"{kind}: {leaf}", answer, words or "done", answer.startswith(words or "done"))


def foreign_packages(user: User) -> Iterator[Figure]:
    """Look at what is said of plugins beside foreign packages, and of a name that one has."""
    doctor = user.run("executive", "plugins", "doctor", may_fail=True).returncode
    told = f"status {doctor}"
    yield judged("`plugins doctor` beside foreign packages", told, "status 0", not doctor)
    words = ("executive", "plugins", "new", "segmentation", FOREIGN[0])
    done = user.run(*words, may_fail=True)
    is_told = done.returncode == 2 and str(user.folder / "foreign") in done.stderr
    yield judged(f"a new package called `{FOREIGN[0]}`", done.stderr.strip(), "refused", is_told)


def _write_site(path: Path) -> None:
    """Write level ground with two boxes: a map of the surroundings."""
    rng = np.random.default_rng(0)
    ground = np.c_[rng.uniform(-8, 8, (60_000, 2)), rng.normal(0.0, 0.01, 60_000)]
    boxes = [np.array([6.0, y, 0.4]) + rng.uniform(-0.4, 0.4, (4000, 3)) for y in (-2.0, 2.0)]
    write_map(path, MapFile(Cloud("map", np.vstack([ground, *boxes])), 0.0, np.eye(4)))


def _outcome(run: Path) -> str:
    report = run / "report.json"
    if not report.is_file():
        return "no report"
    return str(json.loads(report.read_text(encoding="utf-8"))["outcome"])


def _answers(run: Path) -> dict[str, str]:
    """Return the last answer of each leaf by its name: the reason or remark, or `done`."""
    answers = {}
    for entry in read_journal(run / "journal.jsonl"):
        leaf = entry.node.rpartition(":")[2].partition("@")[0]
        if isinstance(entry.event, LeafAnswered):
            answers[leaf] = entry.event.reason or "done"
        elif isinstance(entry.event, NodeTimedOut):
            answers[leaf] = f"took longer than {entry.event.limit_s:g} s"
    return answers


def _say(text: str) -> None:
    print(text.strip(), file=sys.stderr, flush=True)
