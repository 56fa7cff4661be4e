"""What a mission is made of."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from executive.clock import Clock
from executive.journal import Journal
from executive.logs.recorder import Recorder
from executive.messages.region import Region
from executive.mission.assembly import Assembly
from executive.mission.guard import GuardSettings
from executive.mission.jobs.jobs import Jobs
from executive.mission.machine_process import MachineProcess
from executive.mission.operator import Operator
from executive.mission.record.account import Account
from executive.mission.record.keeper import Keeper
from executive.mission.record.leaf_memory import LeafMemory


@dataclass(frozen=True, slots=True)
class Setup:
    """What a mission is made of."""

    clock: Clock
    tick_s: float
    time_limit_s: float
    seed: int
    assembly: Assembly
    jobs: Jobs
    journal: Journal
    account: Account
    operator: Operator
    memory: LeafMemory
    keeper: Keeper
    folder: Path
    recorder: Recorder | None
    regions: Mapping[str, Region]
    can_fail: frozenset[tuple[str, str]]  # capability and name: `on_error: fail`
    guard: GuardSettings
    heartbeat_limit_s: float  # the supervisor stops a loop that is silent for longer; 0: none
    machine: MachineProcess | None  # of a simulated machine that lives apart
    late_ticks: int | None  # in a row, that bring the safe stop; None: by the machine
