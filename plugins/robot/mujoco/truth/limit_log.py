"""How near the machine comes to its limits: joints, oil, and tipping, at every control step."""

from collections.abc import Iterator

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.truth.ground_reaction import GroundReaction
from executive_plugins.robot.mujoco.truth.truth_file import Records

from executive.arrays import Float
from executive.errors import DataError
from executive.interfaces.truth import LimitUse
from executive.machine.machine import Machine

_TIPPING_S = 0.05  # between two looks at the moments: a machine on four points tips slower
_EPSILON_S = 1e-6
_ENDLESS = (-np.inf, np.inf)
_MERGE_S = 0.2  # times beyond one limit that are separated by less count as one, as contacts do


class LimitLog:
    """The largest share of each limit, and how often and how long each was passed.

    The limits of a joint of the arm are its range, its speed and its effort; the flow of the pump
    bounds all joints together, and the weight of the machine holds it on its points of support. The
    jaws are left out: they press, by their force, against stones and against their own stops.
    """

    def __init__(self, machine: Machine, model: mujoco.MjModel) -> None:
        names = machine.arm_names
        joints = [model.joint(name) for name in names]
        self._qpos = np.array([joint.qposadr[0] for joint in joints])
        self._dofs = np.array([joint.dofadr[0] for joint in joints])
        lower, upper = np.array([joint.range or _ENDLESS for joint in machine.joints]).T
        self._middle = np.where(np.isfinite(lower), lower, 0.0) / 2
        self._middle += np.where(np.isfinite(upper), upper, 0.0) / 2
        efforts = [joint.max_effort for joint in machine.joints]
        # Half of the range, speed and effort, shape (3, n).
        self._limits = np.array([(upper - lower) / 2, machine.max_velocity, efforts])
        self._oil: Float | None = None
        if machine.hydraulics is not None:
            oil = np.array([machine.hydraulics.displacement[name] for name in names])
            self._oil = oil / machine.hydraulics.pump_flow_m3_s
        self._reaction = GroundReaction(machine, model) if machine.stance.supports_m else None
        self._uses = (
            *((kind, name) for kind in ("position", "speed", "effort") for name in names),
            *((("flow", "pump"),) if self._oil is not None else ()),
            *((("tipping", machine.base_link),) if self._reaction is not None else ()),
        )
        n = len(self._uses)
        self._largest, self._at_s, self._beyond_s = np.zeros(n), np.zeros(n), np.zeros(n)
        self._times, self._passed_s = np.zeros(n), np.full(n, -np.inf)
        self._last_s: float | None = None
        self._weighed_s, self._tipping = 0.0, 0.0

    def step(self, time_s: float, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Note the shares at the end of a control step."""
        if self._last_s is None:  # before the first step no force is known
            self._last_s = self._weighed_s = time_s
            return
        shares = self._shares(time_s, model, data)
        # The process of a run that goes on begins at another time.
        step_s, self._last_s = min(time_s - self._last_s, _MERGE_S), time_s
        more = shares > self._largest
        self._largest[more], self._at_s[more] = shares[more], time_s
        beyond = shares > 1.0
        if beyond.any():
            self._times[beyond] += time_s - self._passed_s[beyond] > _MERGE_S
            self._beyond_s[beyond] += step_s
            self._passed_s[beyond] = time_s

    def found(self) -> tuple[LimitUse, ...]:
        """Return what became of each limit."""
        return tuple(self._found())

    def records(self) -> Records:
        """Return all that was noted, as arrays by name."""
        columns = [self._largest, self._at_s, self._times, self._beyond_s]
        return {"limits": np.array(columns)}

    def take(self, records: Records, zero_s: float) -> None:
        """Take what `records` returned in another process instead of what was noted here.

        Args:
            records: Its records.
            zero_s: The time of that process's clock that is taken as zero [s].

        Raises:
            DataError: If they lack the limits, or are of other ones.
        """
        columns = np.asarray(records.get("limits", ()), dtype=np.float64)
        if columns.shape != (4, len(self._uses)):
            raise DataError("the truth of the run lacks how near the machine came to its limits")
        self._largest, at_s, self._times, self._beyond_s = columns
        self._at_s = at_s - zero_s

    def _found(self) -> Iterator[LimitUse]:
        endless = np.flatnonzero(np.isinf(self._limits.ravel()))
        for i, (kind, of) in enumerate(self._uses):
            if i in endless:
                continue
            yield LimitUse(
                kind=kind,
                of=of,
                largest_share=round(float(self._largest[i]), 4),
                at_s=round(float(self._at_s[i]), 2),
                times_beyond=int(self._times[i]),
                beyond_s=round(float(self._beyond_s[i]), 2),
            )

    def _shares(self, time_s: float, model: mujoco.MjModel, data: mujoco.MjData) -> Float:
        """Return the share of each limit now; that of tipping is some control steps old."""
        now = np.array(
            [
                data.qpos[self._qpos] - self._middle,
                data.qvel[self._dofs],
                data.qfrc_actuator[self._dofs],
            ]
        )
        shares = np.abs(now) / self._limits
        others = []
        if self._oil is not None:
            others.append(self._oil @ np.abs(now[1]))
        if self._reaction is not None:
            if time_s - self._weighed_s >= _TIPPING_S - _EPSILON_S:
                self._tipping, self._weighed_s = self._reaction.share(model, data), time_s
            others.append(self._tipping)
        return np.array([*shares.ravel(), *others])
