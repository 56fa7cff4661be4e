"""The newest seconds of a body that moves, as one least-squares problem."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import gtsam
import numpy as np
from executive_plugins.estimation.factors import (
    fix_factor,
    inertial_factor,
    insert,
    keys,
    late_fix_factor,
)
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    InertialState,
    propagate_through,
)
from executive_plugins.estimation.inertial.steady_rate import SteadyRate
from executive_plugins.estimation.start.window_solution import Solution, Speeds, levelled, solved
from scipy.linalg import solve_triangular

from executive.arrays import Float
from executive.geometry import chi_square
from executive.geometry.rotation import from_rpy

CLOCK = gtsam.symbol("d", 0)  # key of the error of the receiver's clock, as far as it is unknown
# The tilt by the mean force of a window errs by the mean acceleration over gravity.
_TILT_STD_RAD = 0.3
_HEADING_STD_RAD = 10.0  # no information (Nubert 2025)
_VELOCITY_STD_M_S = 30.0
_BY_CHANCE = 0.01  # probability of a misfit of few residuals that counts as chance
_HELD_STD_RAD = 0.05  # of a heading that is held: far less than what a heading is known to


@dataclass(frozen=True, slots=True, eq=False)
class Knowledge:
    """What is known before a window is solved.

    Attributes:
        gyro_bias: Bias of the gyroscope [rad/s], shape (3,).
        gyro_bias_std_rad_s: Its standard deviation [rad/s].
        guessed_bias: First guess of the bias [rad/s], shape (3,).
        late_s: Stamps of the fixes minus times of measurement, by which the nodes were corrected.
        clock_std_s: Standard deviation of what was not corrected [s]; 0 if the clocks agree.
    """

    gyro_bias: Float
    gyro_bias_std_rad_s: float
    guessed_bias: Float
    late_s: float
    clock_std_s: float


Nodes = Sequence[tuple[float, Sequence[Fix]]]  # times [s], each with its fixes; oldest first


class WindowProblem:
    """Nodes at fixes, inertial factors between them, and first guesses for any heading.

    A clock that is not known moves each fix by its error times the speed of the antenna. The
    speeds are those of a solution in which the stamps are right: as unknowns of the same problem
    they would fit the noise of the fixes, the better the larger the error of the clock is.
    """

    def __init__(
        self, nodes: Nodes, samples: SampleBuffer, noise: InertialNoise, known: Knowledge
    ) -> None:
        self._nodes, self._samples, self._noise, self._known = nodes, samples, noise, known
        self._reckoned = self._dead_reckoned()
        self._rates = self._steady_rates()
        between = [
            samples.between(state.stamp_s, end_s)
            for state, (end_s, _) in zip(self._reckoned, nodes[1:], strict=False)
        ]
        self._between = [
            inertial_factor((i, i + 1), self._reckoned[i], inside, noise)
            for i, inside in enumerate(between)
        ]
        self._priors = self._weak_priors()

    @property
    def _has_clock(self) -> bool:
        return self._known.clock_std_s > 0

    def _steady_rates(self) -> list[Float]:
        """Return the angular velocity at each node, by which an antenna tells the clock, (3,)."""
        if not self._has_clock:
            return [state.rate for state in self._reckoned]
        steady = SteadyRate(self._samples, self._noise)
        return [steady.at(state.stamp_s) - state.gyro_bias for state in self._reckoned]

    def solved(self, heading_rad: float) -> Solution | None:
        """Return the solution that is reached from a heading; None if there is none."""
        values = self.guess(heading_rad)
        found = solved(self.graph(), values)
        if found is None or not self._has_clock:
            return found
        values, speeds = gtsam.Values(found.values), self._speeds(found.values)
        values.insert(CLOCK, np.zeros(1))
        return solved(self.graph(speeds), values, speeds)

    def graph(self, speeds: Speeds | None = None) -> gtsam.NonlinearFactorGraph:
        """Return all factors.

        Args:
            speeds: Velocity of each fix's antenna in the map [m/s], by which an error of the clock
                moves it; None if the stamps are right.
        """
        graph = gtsam.NonlinearFactorGraph()
        for i, (_, fixes) in enumerate(self._nodes):
            for k, fix in enumerate(fixes):
                late = None if speeds is None else late_fix_factor(i, CLOCK, fix, speeds[i][k])
                graph.add(fix_factor(i, fix) if late is None else late)
            if i < len(self._between):
                graph.add(self._between[i])
        graph.push_back(self._priors)
        if speeds is not None:
            std = gtsam.noiseModel.Isotropic.Sigma(1, self._known.clock_std_s)
            graph.add(gtsam.PriorFactorVector(CLOCK, np.array([-self._known.late_s]), std))
        return graph

    def _speeds(self, values: gtsam.Values) -> Speeds:
        """Return the velocity of each fix's antenna in the map [m/s]."""
        speeds = []
        for i, (_, fixes) in enumerate(self._nodes):
            x, v, _b = keys(i)
            R, velocity = values.atPose3(x).rotation().matrix(), values.atVector(v)
            speeds.append([velocity + R @ np.cross(self._rates[i], fix.arm_imu) for fix in fixes])
        return speeds

    def _weak_priors(self) -> gtsam.NonlinearFactorGraph:
        """Return factors on what the window may leave open: biases, and weakly pose and speed."""
        graph = gtsam.NonlinearFactorGraph()
        _x, v, b = keys(0)
        known, diagonal = self._known, gtsam.noiseModel.Diagonal.Sigmas
        # A prior of each first guess' own heading would favour none; this one costs π²/200 at most.
        level = self._reckoned[0].R_map_imu
        graph.add(self._pose_prior(level, _HEADING_STD_RAD, _TILT_STD_RAD))
        speed = gtsam.noiseModel.Isotropic.Sigma(3, _VELOCITY_STD_M_S)
        graph.add(gtsam.PriorFactorVector(v, np.zeros(3), speed))
        bias = gtsam.imuBias.ConstantBias(np.zeros(3), known.gyro_bias)
        std = np.repeat([self._noise.accel_bias_m_s2, known.gyro_bias_std_rad_s], 3)
        graph.add(gtsam.PriorFactorConstantBias(b, bias, diagonal(std)))
        return graph

    def _dead_reckoned(self) -> list[InertialState]:
        """Return dead-reckoned states at the nodes, level but of arbitrary heading."""
        at_s, bias, zero = self._nodes[0][0], self._known.guessed_bias, np.zeros(3)
        state = InertialState(self._samples.at(at_s), np.eye(3), zero, zero, bias, zero)
        turned, forces = [state], []
        for end_s, _ in self._nodes[1:]:
            samples = self._samples.between(turned[-1].stamp_s, end_s)
            forces.append(turned[-1].R_map_imu @ np.mean([s.force for s in samples], axis=0))
            turned.append(propagate_through(turned[-1], samples, 0.0))
        # Over some seconds, the mean acceleration is small beside gravity.
        level = levelled(np.mean(forces, axis=0))
        return [
            replace(state, R_map_imu=level @ state.R_map_imu, p_map_imu=zero, v_map_imu=zero)
            for state in turned
        ]

    def guess(self, heading_rad: float) -> gtsam.Values:
        """Return first values: the dead-reckoned attitudes turned by a heading, at the fixes."""
        turn = from_rpy(0.0, 0.0, heading_rad)
        stamps = np.array([at_s for at_s, _ in self._nodes])
        attitudes = [turn @ state.R_map_imu for state in self._reckoned]
        positions = np.array(
            [
                np.mean([fix.p_map_antenna - R @ fix.arm_imu for fix in fixes], axis=0)
                for R, (_, fixes) in zip(attitudes, self._nodes, strict=True)
            ]
        )
        velocities = np.gradient(positions, stamps, axis=0)
        values = gtsam.Values()
        for i, (state, R) in enumerate(zip(self._reckoned, attitudes, strict=True)):
            p, v = positions[i], velocities[i]
            insert(values, i, replace(state, R_map_imu=R, p_map_imu=p, v_map_imu=v))
        return values

    def held(self, solution: Solution, turn_rad: float) -> Solution | None:
        """Return the solution with the heading held elsewhere; None if there is none.

        Args:
            solution: A solution.
            turn_rad: By how much the heading is turned from it [rad].
        """
        guess = self.turned(solution.values, turn_rad)
        first, _v, _b = keys(0)
        graph = self.graph(solution.speeds)
        graph.add(self._pose_prior(guess.atPose3(first).rotation().matrix(), _HELD_STD_RAD, 1e3))
        return solved(graph, guess, solution.speeds)

    def turned(self, values: gtsam.Values, turn_rad: float) -> gtsam.Values:
        """Return values with another heading [rad], which leave the antennas at the fixes."""
        turn, guess = from_rpy(0.0, 0.0, turn_rad), gtsam.Values(values)
        for i, (_, fixes) in enumerate(self._nodes):
            x, _v, _b = keys(i)
            T, arm = values.atPose3(x), np.mean([fix.arm_imu for fix in fixes], axis=0)
            R = turn @ T.rotation().matrix()
            p = T.translation() + T.rotation().matrix() @ arm - R @ arm
            guess.update(x, gtsam.Pose3(gtsam.Rot3(R), p))
        return guess

    def _pose_prior(
        self, R: Float, heading_std_rad: float, tilt_std_rad: float
    ) -> gtsam.NonlinearFactor:
        """Return a factor on the first attitude that leaves its position open."""
        P = np.eye(6) * 1e6
        tilt, heading = tilt_std_rad**2, heading_std_rad**2
        P[:3, :3] = R.T @ np.diag([tilt, tilt, heading]) @ R
        level = gtsam.Pose3(gtsam.Rot3(R), np.zeros(3))
        return gtsam.PriorFactorPose3(keys(0)[0], level, gtsam.noiseModel.Gaussian.Covariance(P))

    def residuals2(self, solution: Solution) -> Float:
        """Return the squared Mahalanobis distance of each fix from a solution, shape (F,)."""
        values, speeds, squares = solution.values, solution.speeds, []
        late_s = 0.0 if speeds is None else float(values.atVector(CLOCK)[0])
        for i, (_, fixes) in enumerate(self._nodes):
            T = values.atPose3(keys(i)[0])
            for k, fix in enumerate(fixes):
                at = T.translation() + T.rotation().matrix() @ fix.arm_imu
                moved = at if speeds is None else at - late_s * speeds[i][k]
                error = fix.p_map_antenna - moved
                squares.append(float(error @ np.linalg.solve(fix.covariance, error)))
        return np.array(squares)

    def free(self, A: Float, root: Float) -> float:
        """Return the degrees of freedom of the fixes' residuals: 3 F less their leverage.

        Much of what is unknown is determined by priors and samples, and not by fixes.

        Args:
            A: Jacobian of all factors, whitened, shape (r, n).
            root: Its triangular factor, shape (n, n).
        """
        rows: list[int] = []
        first = 0
        for i, (_, fixes) in enumerate(self._nodes):
            rows += range(first, first + 3 * len(fixes))
            first += 3 * len(fixes) + DIMENSION * (i + 1 < len(self._nodes))
        leverage = solve_triangular(root, A[rows].T, trans="T")
        return len(rows) - float(np.square(leverage).sum())

    def ordering(self) -> gtsam.Ordering:
        """Return all keys, the newest node's and the clock's last."""
        ordering = gtsam.Ordering()
        for node in range(len(self._nodes)):
            for key in keys(node):
                ordering.push_back(key)
        if self._has_clock:
            ordering.push_back(CLOCK)
        return ordering


def misfit(squares: Float, free: float, unknowns: int) -> float:
    """Return the factor on the variance of fixes that explains their residuals.

    Args:
        squares: Squared Mahalanobis distances of fixes from a solution, shape (F,).
        free: Their number of degrees of freedom: 3 F less what the fixes have determined.
        unknowns: Number of unknowns that fixes may determine. Fewer residuals than that tell only
            of a misfit that chance does not explain.
    """
    if free <= 1.0 or (free < unknowns and squares.sum() <= chi_square.bound(_BY_CHANCE, free)):
        return 1.0
    return float(np.median(squares) / chi_square.median(3)) * 3 * len(squares) / free
