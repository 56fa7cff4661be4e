"""A whole recording as one least-squares problem over keyframes, antennas and clocks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import gtsam
import numpy as np
from executive_plugins.estimation.calibration.unknown_arm_factor import unknown_arm_factor
from executive_plugins.estimation.factors import extract, inertial_factor, insert, keys
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    InertialState,
    propagate_through,
)

from executive.arrays import Float

_ITERATIONS = 30
_POSE = 6  # dimensions
# Of the gyroscope's and the accelerometer's bias: slower walks make the square root singular.
_LEAST_WALKS = (1e-5, 1e-4)


@dataclass(frozen=True, slots=True, eq=False)
class Receiver:
    """Antennas whose fixes share one clock.

    Attributes:
        antennas: Their names.
        late_s: Stamps minus times of measurement [s].
        scale: Factor on the declared covariance of their fixes.
    """

    antennas: tuple[str, ...]
    late_s: float
    scale: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Unknowns:
    """What a problem solves for besides the motion.

    Attributes:
        arms_imu: Antennas in IMU axes [m], shape (3,) each, by name; the newest guess.
        declared_imu: The same as they were declared.
        receivers: Clocks, and what scales the fixes; the newest guess.
        arm_std_m: How far the declared arms may be off [m].
        clock_std_s: How far the clocks may be off [s].
    """

    arms_imu: Mapping[str, Float]
    declared_imu: Mapping[str, Float]
    receivers: tuple[Receiver, ...]
    arm_std_m: float
    clock_std_s: float


@dataclass(frozen=True, slots=True, eq=False)
class Solved:
    """The solution of one problem.

    Attributes:
        unknowns: With the arms and clocks that were found.
        moved_s: The largest change of a clock [s].
        covariance: Of the arms in the order of `arms_imu` and then the clocks, (3 A + C, 3 A + C).
        attitude: Covariance of an attitude in the middle of the recording [rad²], IMU axes, (3, 3).
        misfit: Squared residuals over their expected sum: 1 if all noise is as declared.
        free: How many residuals are left over by the unknowns.
        states: The motion at the keyframes.
    """

    unknowns: Unknowns
    moved_s: float
    covariance: Float
    attitude: Float
    misfit: float
    free: int
    states: Sequence[InertialState]


class KeyframeProblem:
    """A pose, a velocity and biases at each time that has fixes; inertial factors between them."""

    def __init__(
        self,
        fixes: Sequence[Fix],
        guesses: Sequence[InertialState],
        samples: SampleBuffer,
        noise: InertialNoise,
        unknowns: Unknowns,
    ) -> None:
        self._samples, self._noise, self._unknowns = samples, noise, unknowns
        self._graph, self._values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        self._arms = {name: gtsam.symbol("l", i) for i, name in enumerate(unknowns.arms_imu)}
        self._clocks = [gtsam.symbol("d", i) for i in range(len(unknowns.receivers))]
        self._of = {name: i for i, one in enumerate(unknowns.receivers) for name in one.antennas}
        self._nodes = self._with_times(fixes, guesses)
        self._residuals = 0
        self._add_motion()
        self._add_constants()

    def _with_times(
        self, fixes: Sequence[Fix], guesses: Sequence[InertialState]
    ) -> list[tuple[InertialState, list[Fix]]]:
        """Return a first guess and the fixes of each keyframe, by the corrected stamps."""
        by_time: dict[float, list[Fix]] = {}
        for fix in fixes:
            at_s = fix.stamp_s - self._unknowns.receivers[self._of[fix.antenna]].late_s
            by_time.setdefault(round(at_s, 6), []).append(fix)
        stamps = np.array([state.stamp_s for state in guesses])
        nodes = []
        for at_s in sorted(by_time):
            if not stamps[0] <= at_s <= min(stamps[-1], self._samples.newest_s):
                continue
            before = guesses[int(np.searchsorted(stamps, at_s, side="right")) - 1]
            between = self._samples.between(before.stamp_s, at_s)
            state = propagate_through(before, between, self._noise.gravity_m_s2)
            nodes.append((replace(state, sample=self._samples.at(at_s)), by_time[at_s]))
        return nodes

    def _add_motion(self) -> None:
        for i, (state, fixes) in enumerate(self._nodes):
            insert(self._values, i, state)
            for fix in fixes:
                self._add_fix(i, fix, state)
            if i + 1 < len(self._nodes):
                later = self._nodes[i + 1][0]
                between = self._samples.between(state.stamp_s, later.stamp_s)
                self._graph.add(inertial_factor((i, i + 1), state, between, self._noise))

    def _add_fix(self, node: int, fix: Fix, state: InertialState) -> None:
        receiver = self._of[fix.antenna]
        x, v, _ = keys(node)
        among = (x, v, self._arms[fix.antenna], self._clocks[receiver])
        covariance = self._unknowns.receivers[receiver].scale * fix.covariance
        self._graph.add(unknown_arm_factor(among, fix.p_map_antenna, covariance, state.rate))
        self._residuals += 3

    def _add_constants(self) -> None:
        unknowns, noise = self._unknowns, self._noise
        std = np.repeat([noise.accel_bias_m_s2, noise.gyro_bias_rad_s], 3)
        zero = gtsam.imuBias.ConstantBias()
        near_zero = gtsam.noiseModel.Diagonal.Sigmas(std)
        self._graph.add(gtsam.PriorFactorConstantBias(keys(0)[2], zero, near_zero))
        arm_noise = gtsam.noiseModel.Isotropic.Sigma(3, unknowns.arm_std_m)
        for name, key in self._arms.items():
            self._values.insert(key, np.array(unknowns.arms_imu[name]))
            declared = np.array(unknowns.declared_imu[name])
            self._graph.add(gtsam.PriorFactorVector(key, declared, arm_noise))
        clock_noise = gtsam.noiseModel.Isotropic.Sigma(1, unknowns.clock_std_s)
        for key, receiver in zip(self._clocks, unknowns.receivers, strict=True):
            self._values.insert(key, np.zeros(1))
            before = np.array([-receiver.late_s])
            self._graph.add(gtsam.PriorFactorVector(key, before, clock_noise))

    def solved(self) -> Solved | None:
        """Return the solution; None if the recording leaves the motion itself open."""
        params = gtsam.LevenbergMarquardtParams()
        params.setLinearSolverType("MULTIFRONTAL_QR")
        params.setMaxIterations(_ITERATIONS)
        try:
            found = gtsam.LevenbergMarquardtOptimizer(self._graph, self._values, params).optimize()
            covariance = self._covariance(found)
        except (RuntimeError, np.linalg.LinAlgError):  # GTSAM's of a singular system
            return None
        free = self._residuals - DIMENSION  # inertial factors add as many residuals as unknowns
        misfit = 2.0 * float(self._graph.error(found)) / max(free, 1)
        if free < DIMENSION or not np.isfinite(misfit) or not np.isfinite(covariance).all():
            return None
        moves_s = [float(found.atVector(key)[0]) for key in self._clocks]
        unknowns = replace(
            self._unknowns,
            arms_imu={name: np.array(found.atVector(key)) for name, key in self._arms.items()},
            receivers=tuple(
                replace(one, late_s=one.late_s + move_s)
                for one, move_s in zip(self._unknowns.receivers, moves_s, strict=True)
            ),
        )
        states = [extract(found, i, state.sample) for i, (state, _) in enumerate(self._nodes)]
        return Solved(
            unknowns,
            max(map(abs, moves_s)),
            covariance[_POSE:, _POSE:],
            covariance[:3, :3],
            misfit,
            free,
            states,
        )

    def _covariance(self, found: gtsam.Values) -> Float:
        """Return the covariance of a pose, the arms and the clocks, by elimination of the rest.

        The pose is that in the middle of the recording, (rotation, translation) in its own axes.
        """
        wanted = [keys(len(self._nodes) // 2)[0], *self._arms.values(), *self._clocks]
        motion = [key for node in range(len(self._nodes)) for key in keys(node)]
        ordering = gtsam.Ordering()
        for key in [key for key in motion if key != wanted[0]] + wanted:
            ordering.push_back(key)
        # By QR: the squares of biases that hardly walk and of the other states span 16 decades.
        net = self._graph.linearize(found).eliminateSequential(ordering, gtsam.EliminateQR)
        last = gtsam.GaussianBayesNet()
        for i in range(net.size() - len(wanted), net.size()):
            last.push_back(net.at(i))
        root = np.linalg.inv(last.matrix()[0])
        return np.asarray(root @ root.T)


def walking(noise: InertialNoise) -> InertialNoise:
    """Return the noise with walks of the biases that a whole recording can be solved with."""
    gyro, accel = _LEAST_WALKS
    return replace(
        noise,
        gyro_bias_walk=max(noise.gyro_bias_walk, gyro),
        accel_bias_walk=max(noise.accel_bias_walk, accel),
    )
