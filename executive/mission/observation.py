"""The world is observed anew after a run was cut off, before anything moves.

The machine may have gone on without this process, and so may the world: the pose is estimated
again, the lidars look from where they stand, and the jaws and the weight tell what is held.
"""

from collections.abc import Generator, Sequence

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.errors import RobotError
from executive.events.mission import WorldObserved
from executive.geometry.pose import transform
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.closed_jaws import asked_whole, holds_nothing
from executive.leaf.weighing import hanging
from executive.machine.sensor import Sensor
from executive.messages.command import SwitchLidars
from executive.messages.lidar import LidarScan
from executive.messages.stone import Stone, StoneState
from executive.messages.verdict import Trouble, Verdict
from executive.mission.context import NodeContext, Services

_NODE = "resume"
_LOCALISED_S = 60.0  # a start at rest takes seconds; beyond that the operator has to look
_SCANS = 5  # revolutions of each lidar
_NEAR_M = 0.10  # a return this near to a stone's model is of that stone: as `objects.agreement_m`
_RETURNS = 5  # of a stone that is seen
_WEIGHED_S = 0.4  # for which it is weighed whether a stone is within closed jaws


class Observation:
    """Looks around, one tick at a time."""

    def __init__(self, services: Services) -> None:
        self._services = services
        self._context = NodeContext(services, _NODE, {})
        self._scans: list[LidarScan] = []

    def steps(self) -> Generator[None, None, None]:
        """Observe; each step waits for the observations of the next tick.

        Raises:
            RobotError: If the machine does not tell its pose or its joints.
        """
        plugins = self._services.plugins
        robot: Robot = plugins["robot"]
        robot.stop()  # what was under way when the run was cut off
        yield from self._localise()
        if "mapping" in plugins and self._lidars():
            yield from self._scan(robot)
        self._record((yield from self._held()))

    def _localise(self) -> Generator[None, None, None]:
        ticks = 0
        while not self._context.state().is_ready or self._services.streams.joints is None:
            ticks += 1
            if ticks * self._services.tick_s > _LOCALISED_S:
                raise RobotError(
                    f"the machine was not localised within {_LOCALISED_S:.0f} s after the run was "
                    f"resumed: its state is {self._context.state().status}. Nothing has moved"
                )
            yield None

    def _scan(self, robot: Robot) -> Generator[None, None, None]:
        rate_hz = min(lidar.rate_hz for lidar in self._lidars())
        robot.command(SwitchLidars(True))
        try:
            for _ in range(round((_SCANS + 1) / rate_hz / self._services.tick_s)):
                yield None
                self._scans += self._services.streams.arrived_scans
        finally:
            robot.command(SwitchLidars(False))

    def _lidars(self) -> Sequence[Sensor]:
        return tuple(self._services.machine.sensors_of("lidar"))

    def _held(self) -> Generator[None, None, Stone | None]:
        """Return the stone that the database says is held, after the monitors were told.

        Closed jaws hold it if it hangs within them.
        """
        if "objects" not in self._services.plugins:
            return None
        stones = self._context.use(ObjectDatabase).stones()
        held = next((stone for stone in stones if stone.state is StoneState.HELD), None)
        if held is None:
            return None
        self._context.begin_hold()
        if not holds_nothing(self._context):
            return held
        least_kg = asked_whole(self._context, held.id).least_kg
        weight = yield from hanging(self._context, _WEIGHED_S, least_kg)
        if weight is not None and weight.mass_kg >= least_kg:
            self._context.begin_carry(weight)
        else:
            now_s = self._context.now_s()
            detail = f"the jaws are closed to {self._jaw_rad():.2f} rad after the run was cut off"
            self._services.verdicts.append(Verdict(now_s, _NODE, Trouble.DROP, detail))
        return held

    def _jaw_rad(self) -> float:
        return self._context.joints().of(self._services.machine.jaw.name)[0]

    def _record(self, held: Stone | None) -> None:
        seen, unseen = self._stones()
        payload_kg = self._context.payload_kg()
        self._context.record(
            WorldObserved(
                status=self._context.state().status,
                jaw_rad=self._jaw_rad(),
                held=None if held is None else held.id,
                is_held=not holds_nothing(self._context),
                payload_kg=None if payload_kg is None else round(payload_kg, 1),
                seen=seen,
                unseen=unseen,
            )
        )

    def _stones(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Return ids of the lying stones that the scans show, and of the others."""
        if "objects" not in self._services.plugins:
            return (), ()
        lying = [one for one in self._context.use(ObjectDatabase).stones() if one.state.is_lying]
        if not self._scans:
            return (), tuple(stone.id for stone in lying)
        returns = cKDTree(np.vstack([self._in_map(scan) for scan in self._scans]))
        seen = [stone.id for stone in lying if _is_seen(stone, returns)]
        return tuple(seen), tuple(stone.id for stone in lying if stone.id not in seen)

    def _in_map(self, scan: LidarScan) -> Float:
        """Return a scan's points in the map [m], shape (N, 3): the machine is at rest."""
        frames = self._services.kinematics.frames(self._context.arm())
        T_map_lidar = self._context.state().T_map_base @ frames[scan.frame]
        return np.asarray(transform(T_map_lidar, scan.points_lidar))


def _is_seen(stone: Stone, returns: cKDTree) -> bool:
    distances, _ = returns.query(stone.points_map, distance_upper_bound=_NEAR_M)
    return int(np.isfinite(distances).sum()) >= _RETURNS
