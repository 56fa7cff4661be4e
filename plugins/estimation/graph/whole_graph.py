"""One factor graph over a whole recording, solved by Levenberg-Marquardt."""

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import gtsam
import numpy as np
from executive_plugins.estimation.factors import (
    between_factor,
    clock_key,
    extract,
    fix_factor,
    inertial_factor,
    insert,
    keys,
    late_fix_factor,
    prior,
)
from executive_plugins.estimation.gate.measurements import Fix, Increment, Measurement
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.standstill_check import StandstillCheck
from executive_plugins.estimation.inertial.measurement_models import antenna_residual
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    Inertial,
    InertialState,
    propagate,
    retract,
)
from executive_plugins.estimation.inertial.steady_rate import SteadyRate

from executive.arrays import Float
from executive.geometry.rotation import log_so3

_SAME_S = 5e-4  # as in the window
_MOST_ITERATIONS = 30
_ENOUGH = 1e-6  # relative decrease of the cost at which the iteration ends
_STANDING_SIGMAS = 5.0  # a chassis that is estimated to be faster than this is not at rest


@dataclass(slots=True)
class Recording:
    """The input of an estimator since one start: the first state and all accepted measurements.

    Attributes:
        first: What it begins with.
        samples: Inertial samples after it.
        measurements: Measurements of any time, in order of arrival.
        estimates: The newest states of the online smoother, in order of time; they give the
            initial values.
    """

    first: GraphEstimate
    samples: list[Inertial] = field(default_factory=list)
    measurements: list[Measurement] = field(default_factory=list)
    estimates: list[InertialState] = field(default_factory=list)


class WholeGraph:
    """Solves one recording, removes the fixes that the solution contradicts, and repeats."""

    def __init__(
        self, recording: Recording, settings: SmootherSettings, noise: InertialNoise
    ) -> None:
        self._settings = settings
        self._noise = noise
        self._first = recording.first
        self._has_clock = not self._first.clock.is_known
        self._late_s = self._first.clock.offset_s
        first = self._first.state
        self._samples = SampleBuffer()
        for sample in (first.sample, *recording.samples):
            self._samples.append(sample)
        self._steady = SteadyRate(self._samples, noise)
        end_s = self._samples.newest_s
        self._measurements = [
            m for m in recording.measurements if _begin_s(m) > first.stamp_s and m.stamp_s <= end_s
        ]
        self._stamps_s = self._node_stamps(end_s)
        self._initial = list(self._guessed([first, *recording.estimates]))
        self.left_out = 0

    def _node_stamps(self, end_s: float) -> list[float]:
        """Return the times of the nodes [s].

        There is a node at each measurement, and often enough that inertial factors stay short.
        """
        wanted = {
            end_s,
            *(m.stamp_s for m in self._measurements),
            *map(_begin_s, self._measurements),
        }
        stamps_s = [self._first.state.stamp_s]
        for stamp_s in sorted(wanted):
            while stamp_s - stamps_s[-1] > 2 * self._settings.node_after_s:
                stamps_s.append(stamps_s[-1] + self._settings.node_after_s)
            if stamp_s - stamps_s[-1] > _SAME_S:
                stamps_s.append(stamp_s)
        return stamps_s

    def _guessed(self, estimates: Sequence[InertialState]) -> Iterator[InertialState]:
        """Yield an initial state for each node: the online estimate before it, propagated."""
        known_s = [state.stamp_s for state in estimates]
        for stamp_s in self._stamps_s:
            i = max(bisect_left(known_s, stamp_s + _SAME_S) - 1, 0)
            yield self._carried(estimates[i], stamp_s)

    def _carried(self, state: InertialState, until_s: float) -> InertialState:
        for sample in self._samples.between(state.stamp_s, until_s):
            state = propagate(state, sample, self._noise.gravity_m_s2)
        return state

    def _node(self, stamp_s: float) -> int:
        return bisect_left(self._stamps_s, stamp_s - _SAME_S)

    @property
    def has_fix(self) -> bool:
        """Whether the recording holds a fix, which ties it to the map."""
        return any(isinstance(m, Fix) for m in self._measurements)

    def solve(self) -> list[InertialState]:
        """Return the most probable states of the nodes."""
        used = self._measurements
        states = self._optimised(self._initial, used)
        kept = [m for m in used if not self._contradicts(m, states)]
        self.left_out = len(used) - len(kept)
        # By the speeds of a solution: those of the online estimates err where it had no fixes.
        return self._optimised(states, kept) if self.left_out or self._has_clock else states

    def _contradicts(self, measurement: Measurement, states: Sequence[InertialState]) -> bool:
        if not isinstance(measurement, Fix):
            return False
        state = states[self._node(measurement.stamp_s)]
        residual, _ = antenna_residual(state, measurement.arm_imu, measurement.p_map_antenna)
        residual = residual + (self._late_s - measurement.late_s) * _speed(
            state, measurement.arm_imu
        )
        distance2 = float(residual @ np.linalg.solve(measurement.covariance, residual))
        return distance2 > self._settings.gate.innovation

    def _optimised(
        self, states: Sequence[InertialState], measurements: Sequence[Measurement]
    ) -> list[InertialState]:
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for node, state in enumerate(states):
            insert(values, node, state)
        if self._has_clock:
            values.insert(clock_key(0), np.array([self._late_s]))
        for factor in self._factors(states, measurements):
            graph.push_back(factor)
        params = gtsam.LevenbergMarquardtParams()
        params.setLinearSolverType(
            "MULTIFRONTAL_QR"
        )  # Cholesky would fail by its squared condition number, as in the window
        params.setMaxIterations(_MOST_ITERATIONS)
        params.setRelativeErrorTol(_ENOUGH)
        values = gtsam.LevenbergMarquardtOptimizer(graph, values, params).optimize()
        self._graph, self._values = graph, values
        if self._has_clock:
            self._late_s = float(values.atVector(clock_key(0))[0])
        return [
            extract(values, node, self._samples.at(stamp_s))
            for node, stamp_s in enumerate(self._stamps_s)
        ]

    def _factors(
        self, states: Sequence[InertialState], measurements: Sequence[Measurement]
    ) -> Iterator[gtsam.NonlinearFactor]:
        given = self._first
        clock = given.clock if self._has_clock else None
        yield from prior(0, given.state, given.covariance, clock)
        for node in range(1, len(states)):
            samples = self._samples.between(self._stamps_s[node - 1], self._stamps_s[node])
            yield inertial_factor((node - 1, node), states[node - 1], samples, self._noise)
        standstill = StandstillCheck(self._settings)
        for measurement in measurements:
            node = self._node(measurement.stamp_s)
            if isinstance(measurement, Fix):
                yield self._fix_factor(node, measurement, states[node])
            elif isinstance(measurement, Increment):
                first = self._node(measurement.from_s)
                yield between_factor(first, node, measurement.T_from_to, measurement.covariance)
            elif not self._moves(states[node], measurement.arm_imu):
                yield from standstill.factors(node, measurement, states[node])

    def _fix_factor(self, node: int, fix: Fix, state: InertialState) -> gtsam.NonlinearFactor:
        """Return a factor of a fix; a clock that is unknown is the same throughout."""
        if not self._has_clock:
            return fix_factor(node, fix)
        return late_fix_factor(node, clock_key(0), fix, self._steady.speed(state, fix.arm_imu))

    def _moves(self, state: InertialState, arm_imu: Float) -> bool:
        speed_m_s = float(np.linalg.norm(_speed(state, arm_imu)))
        return speed_m_s > _STANDING_SIGMAS * self._settings.standing_velocity_std_m_s

    def covariances(self) -> Iterator[Float]:
        """Yield the covariance of each node's error, shape (15, 15).

        Only the blocks of the pose are computed; all others are zero.
        """
        marginals = gtsam.Marginals(self._graph, self._values)
        for node in range(len(self._stamps_s)):
            x = keys(node)[0]
            R = self._values.atPose3(x).rotation().matrix()
            J = np.zeros((DIMENSION, 6))
            J[ROTATION, :3], J[POSITION, 3:] = np.eye(3), R
            yield J @ marginals.marginalCovariance(x) @ J.T

    def between(self, states: Sequence[InertialState], node: int) -> Iterator[InertialState]:
        """Yield the states at the samples between a node and the next.

        They are propagated from the node. The misfit at the next node is distributed linearly in
        time, so that there is no step.
        """
        begin, end = states[node], states[node + 1]
        path = [begin]
        for sample in self._samples.between(begin.stamp_s, end.stamp_s):
            path.append(propagate(path[-1], sample, self._noise.gravity_m_s2))
        reached = path[-1]
        miss = np.zeros(DIMENSION)
        miss[ROTATION] = log_so3(reached.R_map_imu.T @ end.R_map_imu)
        miss[3:6] = end.v_map_imu - reached.v_map_imu
        miss[POSITION] = end.p_map_imu - reached.p_map_imu
        for state in path[1:]:
            share = (state.stamp_s - begin.stamp_s) / (end.stamp_s - begin.stamp_s)
            yield retract(state, share * miss)

    def is_sample(self, stamp_s: float) -> bool:
        """Return whether a sample ends at a time; nodes may lie within a sample."""
        return self._samples.ends_at(stamp_s)

    def __len__(self) -> int:
        return len(self._stamps_s)


def _speed(state: InertialState, arm_imu: Float) -> Float:
    """Return the velocity of a point at `arm_imu` [m] in the map [m/s], shape (3,)."""
    return np.asarray(state.v_map_imu + state.R_map_imu @ np.cross(state.rate, arm_imu))


def _begin_s(measurement: Measurement) -> float:
    return measurement.from_s if isinstance(measurement, Increment) else measurement.stamp_s
