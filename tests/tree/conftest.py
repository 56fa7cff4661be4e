"""A small world to load and tick missions in: a few leaves and plugins, a clock, and a journal kept
as a list.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from py_trees.behaviour import Behaviour
from py_trees.common import Status
from pydantic import Field

from executive.clock import SimulatedClock
from executive.config import Radians, Seconds, Settings
from executive.events.event import Event
from executive.interfaces.mapping import Mapper
from executive.interfaces.plugin import Plugin
from executive.interfaces.registration import Registrar
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.context import Context
from executive.leaf.job import Job
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.runtime import MissionFaultError, Question, Runtime
from executive.leaf.store import Store
from executive.tree.build import build_tree, halt
from executive.tree.catalogue import TableCatalogue
from executive.tree.load import load_mission

TICK_S = 0.1
DRY_MISSION = """api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
trees:
  main:
    run: Localise
    timeout: 30 s
"""  # the smallest mission of shipped plugins


class Cloud:
    """A value."""


class Stone:
    """A value."""


class BigStone(Stone):
    """A value that can be used as a Stone."""


class ScanSettings(Settings):
    angle: Radians = Field(1.0, gt=0, le=7, description="Angle [rad].")
    duration: Seconds = Field(0.2, ge=0, description="Duration [s].")
    label: str = Field("", description="A text.")
    turns: int = Field(1, ge=1, description="A count.")


@dataclass(frozen=True)
class Seen:
    """What a scan gives.

    Attributes:
        cloud: What was seen.
    """

    cloud: Cloud


class Scan(Action[ScanSettings]):
    """Take `duration` and give a cloud."""

    needs = (Mapper,)

    def run(self) -> Steps[Seen]:
        for _ in range(round(self.settings.duration / TICK_S)):
            yield None
        return succeeded(Seen(Cloud()), "seen")


@dataclass(frozen=True)
class Found:
    """What is found.

    Attributes:
        stones: What was found.
    """

    stones: list[Stone]


class FindStones(Action):
    """Find stones in a cloud, at once."""

    def run(self, cloud: Cloud) -> Steps[Found]:
        """Find them.

        Args:
            cloud: Where to look.
        """
        yield from ()
        return succeeded(Found([Stone(), BigStone()]))


@dataclass(frozen=True)
class Picked:
    """What a pick gives.

    Attributes:
        held: Whether it is held.
    """

    held: bool


class Pick(Action):
    """Pick a stone."""

    def run(self, stone: Stone, tool: str | None = None) -> Steps[Picked]:
        """Pick it.

        Args:
            stone: What to pick.
            tool: What with.
        """
        yield None
        return succeeded(Picked(True), f"with {tool}")


class Register(Action):
    """Needs a capability that the missions here do not select."""

    needs = (Registrar,)

    def run(self) -> Steps[None]:
        yield None
        return succeeded()


class HasStones(Condition):
    """Whether the list is not empty."""

    def check(self, stones: list[Stone]) -> Outcome[None]:
        """Look at the list.

        Args:
            stones: The list.
        """
        return succeeded() if stones else failed("no stones")


class Calm(Condition):
    """Whether the wind is low."""

    def check(self) -> Outcome[None]:
        return succeeded(reason="calm")


class StonesSettings(Settings):
    count: int = Field(7, ge=0, le=50, description="How many.")


class SiteSettings(Settings):
    stones: StonesSettings = StonesSettings()
    size_m: tuple[float, float] = Field((10.0, 10.0), description="Size [m].")


class RobotSettings(Settings):
    model: str = Field("m545", description="The machine.")
    site: SiteSettings = SiteSettings()


class Mujoco(Plugin):
    Settings = RobotSettings


class VoxelSettings(Settings):
    voxel_m: float = Field(0.05, gt=0, description="Edge [m].")


class VoxelMap(Plugin):
    Settings = VoxelSettings

    def __init__(self, settings: Settings, machine: Any) -> None: ...


class PoseGraph(Plugin):
    def __init__(self, settings: Settings, alignment: Any) -> None: ...


class Strange(Plugin):
    def __init__(self, settings: Settings, moon: Any) -> None: ...


class PathSettings(Settings):
    path: str = Field(description="Required.")


class PointCloudFile(Plugin):
    Settings = PathSettings


PLUGINS: Mapping[str, Mapping[str, type[Plugin]]] = {
    "robot": {"mujoco": Mujoco, "replay": Plugin},
    "estimation": {"gnss_imu": Plugin},
    "mapping": {"voxel_map": VoxelMap, "pose_graph": PoseGraph},
    "segmentation": {"strange": Strange},
    "surveying": {"point_cloud_file": PointCloudFile},
    "alignment": {"gicp": Plugin},
    "registration": {"segment_fpfh": Plugin},
    "monitoring": {"jaw_slip": VoxelMap, "payload_drop": Plugin},
}
LEAVES = {leaf.__name__: leaf for leaf in (Scan, FindStones, Pick, Register, HasStones, Calm)}
HEADER = (
    "api: 1\nmission: test\nplugins: {robot: mujoco, estimation: gnss_imu, mapping: voxel_map}\n"
)


@pytest.fixture
def catalogue() -> TableCatalogue:
    return TableCatalogue(LEAVES, PLUGINS)


class FakeRuntime(Runtime):
    """Keeps what nodes tell, and answers questions after a number of polls."""

    def __init__(self) -> None:
        self.clock = SimulatedClock()
        self.store = Store()
        self.lines: list[tuple[str, str, Mapping[str, Any]]] = []
        self.errors: list[BaseException] = []
        self.answer: Question | Exception | None = None
        self.can_do_without = False

    def context(self, node: str, uses: Mapping[str, str]) -> Context:
        return FakeContext(self, node)  # type: ignore[abstract]

    def record(self, node: str, event: Event) -> None:
        self.lines.append((event.kind, node, event.payload()))

    def ask(
        self, node: str, question: str, default: bool | str | None, choices: Sequence[str] = ()
    ) -> Question:
        if isinstance(self.answer, Exception):
            raise self.answer
        assert self.answer is not None
        return self.answer

    def fail(self, error: Exception, node: str, leaf: str) -> str:
        self.errors.append(error)
        if self.can_do_without:
            return f"{leaf} failed: {error}"
        self.is_faulted = True
        raise MissionFaultError(f"{leaf} failed: {error}") from error

    def told(self, kind: str) -> list[str]:
        """Return the paths of the lines of a kind."""
        return [node for one, node, _ in self.lines if one == kind]

    def endings(self) -> list[tuple[str, str]]:
        """Return path and status of every node that ended."""
        return [
            (node, payload["status"]) for kind, node, payload in self.lines if kind == "node_ended"
        ]


class FakeContext(Context):
    def __init__(self, runtime: FakeRuntime, node: str) -> None:
        self.runtime = runtime
        self.node = node


FakeContext.__abstractmethods__ = frozenset()  # type: ignore[attr-defined]  # leaves here use what they bring


class FakeJob(Job):
    """Ready after so many polls."""

    def __init__(self, polls: int, result: Any = None) -> None:
        self.polls = polls
        self.is_cancelled = False
        self._result = result

    def is_ready(self) -> bool:
        self.polls -= 1
        return self.polls < 0

    def result(self) -> Any:
        if isinstance(self._result, Exception):
            raise self._result
        return self._result

    def cancel(self) -> None:
        self.is_cancelled = True


@dataclass
class Play:
    """A tree that is ticked."""

    root: Behaviour
    runtime: FakeRuntime
    ticks: int = 0
    statuses: list[str] = field(default_factory=list)

    @property
    def status(self) -> str:
        return self.root.status.name

    @property
    def reason(self) -> str:
        return self.root.feedback_message

    def tick(self, times: int = 1) -> str:
        """Tick so often, and return the status."""
        for _ in range(times):
            self.root.tick_once()
            self.runtime.clock.advance(TICK_S)
            self.ticks += 1
        return self.status

    def finish(self, limit: int = 500) -> str:
        """Tick to the end."""
        self.tick()
        while self.root.status is Status.RUNNING:
            assert self.ticks < limit, "the tree does not end"
            self.tick()
        return self.status

    def halt(self) -> None:
        halt(self.root)


@pytest.fixture
def load(tmp_path: Path, catalogue: TableCatalogue) -> Any:
    """Load a mission from the text of its trees, or from a whole file's text."""

    def load_text(
        trees: str, *overrides: str, leaves: Mapping[str, type] | None = None, header: str = HEADER
    ) -> Any:
        path = tmp_path / "mission.yaml"
        path.write_text(header + trees, encoding="utf-8")
        known = TableCatalogue({**LEAVES, **(leaves or {})}, PLUGINS)
        return load_mission(str(path), overrides, known)

    return load_text


@pytest.fixture
def play(load: Any) -> Any:
    """Load and build a mission whose `main` is given, indented or not."""

    def play_text(
        main: str, *, leaves: Mapping[str, type] | None = None, trees: str = "", store: Any = None
    ) -> Play:
        body = "".join(f"    {line}\n" for line in main.strip("\n").splitlines())
        mission = load(f"trees:\n  main:\n{body}{trees}", leaves=leaves)
        runtime = FakeRuntime()
        for key, value in (store or {}).items():
            runtime.store.set(key, value)
        return Play(build_tree(mission, runtime), runtime)

    return play_text


@pytest.fixture
def job() -> Any:
    """Return the class of jobs that are ready after a number of polls."""
    return FakeJob
