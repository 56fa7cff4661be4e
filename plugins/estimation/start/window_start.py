"""The first state of a body that moves: its newest seconds as one problem, from several headings.

Source: the start of Nubert 2025 (arXiv 2504.06479), a prior of 180 deg in heading and 10 m/s in
velocity instead of a rest. Deviation: a heading is not taken from one linearisation; the problem
is solved from several, and the estimate begins when one is left.
"""

from collections import deque
from collections.abc import Generator, Sequence

import gtsam
import numpy as np
from executive_plugins.estimation.factors import (
    covariance_of,
    extract,
    fix_factor,
    inertial_factor,
    insert,
    keys,
)
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    Inertial,
    InertialState,
    carry_covariance,
    propagate,
    propagate_through,
)
from executive_plugins.estimation.start.settings import WindowStartSettings
from executive_plugins.estimation.start.window_solution import (
    Solution,
    heading_std,
    levelled,
    solved,
)

from executive.arrays import Float
from executive.geometry.rotation import from_rpy, wrap_angle

_NODES = 30  # at most, in a window
_HEADINGS = 4  # first guesses; the basin of attraction is wider than a quarter of a turn
_STEP_S = 0.05  # between two steps of an attempt
_GROWTH = 1.25  # of the window, from one attempt to the next
_FIRST_SPAN_S = 0.8
_VELOCITY_STD_M_S = 30.0
_ATTITUDE_STD_RAD = np.pi
# Two solutions are two hypotheses if they differ by more than this; the worse one is refuted if
# the data are e⁷ = 1,100 times less likely under it.
_SAME_RAD = 0.3
_REFUTED = 7.0


class WindowStart:
    """Collects samples and fixes, and solves for the motion that explains them.

    Nothing need be at rest, and the first heading is unknown. The heading follows from two
    antennas, or from the difference of the accelerations by the fixes and by the samples.

    Attributes:
        waits_for: Why there is no state yet; empty before the first attempt.
    """

    def __init__(self, settings: WindowStartSettings, noise: InertialNoise) -> None:
        self._settings, self._noise = settings, noise
        self._samples = SampleBuffer()
        self._fixes: deque[Fix] = deque()
        self._first_s: float | None = None  # of the samples
        self._next_span_s = _FIRST_SPAN_S
        self._tried_s = self._stepped_s = -np.inf
        self._attempt: Generator[None, None, tuple[InertialState, Float] | None] | None = None
        self._bias = np.zeros(3)  # of the gyroscope, by the newest attempt
        self._rest_bias, self._rest_std_rad_s = np.zeros(3), noise.gyro_bias_rad_s
        self.waits_for = ""

    def add_sample(self, sample: Inertial) -> None:
        """Add one inertial sample."""
        self._first_s = sample.stamp_s if self._first_s is None else self._first_s
        self._samples.append(sample)
        oldest_s = sample.stamp_s - self._settings.window_s
        self._samples.forget_before(oldest_s)
        while self._fixes and self._fixes[0].stamp_s < oldest_s:
            self._fixes.popleft()

    def add_fix(self, fix: Fix) -> None:
        """Add a fix; one that is older than the samples is left out."""
        if self._first_s is not None and fix.stamp_s >= self._first_s:
            self._fixes.append(fix)

    def take_rest(self, gyro_bias: Float, std_rad_s: float) -> None:
        """Take the bias of the gyroscope as a body at rest shows it [rad/s], shape (3,).

        Fixes of one antenna do not tell a turn about it from a bias.
        """
        self._rest_bias, self._rest_std_rad_s = gyro_bias, std_rad_s

    def state(self) -> tuple[InertialState, Float] | None:
        """Return the state at the newest sample and its error's covariance (15, 15), if found.

        An attempt is made of steps, one in `_STEP_S` at most: no tick waits for a whole one.
        """
        if self._attempt is None:
            self._attempt = self._steps() if self._is_due() else None
        if self._attempt is None or self._samples.newest_s - self._stepped_s < _STEP_S:
            return None
        self._stepped_s = self._samples.newest_s
        try:
            next(self._attempt)
        except StopIteration as end:
            self._attempt = None
            found: tuple[InertialState, Float] | None = end.value
            return None if found is None else self._carried(*found)
        return None

    def _steps(self) -> Generator[None, None, tuple[InertialState, Float] | None]:
        """Solve from one heading after the other; return the newest node's state if it is sure."""
        nodes = self._nodes()
        if len(nodes) < 2:
            self.waits_for = "fixes: fewer than two times so far"
            return None
        reckoned = self._reckoned(nodes)
        graph = self._graph(nodes, reckoned)
        solutions = []
        for k in range(_HEADINGS):
            yield
            guess = self._guess(reckoned, nodes, 2 * np.pi * k / _HEADINGS)
            solution = solved(graph, guess, len(nodes) - 1)
            if solution is not None:
                solutions.append(solution)
        yield
        return self._judged(sorted(solutions, key=lambda one: one.cost), nodes)

    def _judged(
        self, solutions: Sequence[Solution], nodes: Sequence[tuple[float, list[Fix]]]
    ) -> tuple[InertialState, Float] | None:
        """Return the best solution's newest state, unless another heading or none is likely."""
        if not solutions:
            self.waits_for = "fixes that fit the inertial samples"
            return None
        best = solutions[0]
        rivals = [
            other
            for other in solutions[1:]
            if other.cost - best.cost < _REFUTED
            and abs(wrap_angle(other.heading_rad - best.heading_rad)) > _SAME_RAD
        ]
        state, covariance = self._newest(best, nodes)
        self._bias = state.gyro_bias
        heading_rad = heading_std(state, covariance)
        if rivals or heading_rad > self._settings.max_heading_std_rad:
            which = (
                f"{len(rivals) + 1} headings explain all fixes"
                if rivals
                else f"its standard deviation is {heading_rad:.2f} rad"
            )
            self.waits_for = f"motion that tells the heading: {which}"
            return None
        return state, covariance

    def _is_due(self) -> bool:
        """Return whether the window has grown enough since the last attempt."""
        if not self._fixes:
            self.waits_for = "fixes"
            return False
        span_s = self._fixes[-1].stamp_s - self._fixes[0].stamp_s
        now_s = self._fixes[-1].stamp_s
        is_full = span_s >= 0.9 * self._settings.window_s
        wait_s = 0.1 * self._settings.window_s if is_full else 0.0
        if now_s - self._tried_s < wait_s or (not is_full and span_s < self._next_span_s):
            return False
        self._tried_s = now_s
        self._next_span_s = max(_GROWTH * span_s, _FIRST_SPAN_S)
        return True

    def _nodes(self) -> list[tuple[float, list[Fix]]]:
        """Return times of the window with their fixes, oldest first, evenly thinned."""
        by_time: dict[float, list[Fix]] = {}
        for fix in sorted(self._fixes, key=lambda fix: fix.stamp_s):
            if fix.stamp_s <= self._samples.newest_s:
                by_time.setdefault(fix.stamp_s, []).append(fix)
        stamps = np.array(list(by_time))
        if len(stamps) < 2:
            return list(by_time.items())
        wanted = np.linspace(stamps[0], stamps[-1], min(_NODES, len(stamps)))
        chosen = np.unique(np.abs(stamps[None, :] - wanted[:, None]).argmin(axis=1))
        return [(float(stamps[i]), by_time[float(stamps[i])]) for i in chosen]

    def _graph(
        self, nodes: Sequence[tuple[float, list[Fix]]], reckoned: Sequence[InertialState]
    ) -> gtsam.NonlinearFactorGraph:
        graph = gtsam.NonlinearFactorGraph()
        for i, (state, (_, fixes)) in enumerate(zip(reckoned, nodes, strict=True)):
            for fix in fixes:
                graph.add(fix_factor(i, fix))
            if i + 1 < len(nodes):
                samples = self._samples.between(state.stamp_s, nodes[i + 1][0])
                graph.add(inertial_factor((i, i + 1), state, samples, self._noise))
        self._add_priors(graph)
        return graph

    def _add_priors(self, graph: gtsam.NonlinearFactorGraph) -> None:
        """Constrain what the window may leave open: the biases, and weakly pose and velocity."""
        x, v, b = keys(0)
        noise = self._noise
        wide = gtsam.noiseModel.Diagonal.Sigmas(np.repeat([_ATTITUDE_STD_RAD, 1e3], 3))
        graph.add(gtsam.PriorFactorPose3(x, gtsam.Pose3(), wide))
        speed = gtsam.noiseModel.Isotropic.Sigma(3, _VELOCITY_STD_M_S)
        graph.add(gtsam.PriorFactorVector(v, np.zeros(3), speed))
        known = gtsam.imuBias.ConstantBias(np.zeros(3), self._rest_bias)
        std = np.repeat([noise.accel_bias_m_s2, self._rest_std_rad_s], 3)
        graph.add(gtsam.PriorFactorConstantBias(b, known, gtsam.noiseModel.Diagonal.Sigmas(std)))

    def _reckoned(self, nodes: Sequence[tuple[float, list[Fix]]]) -> list[InertialState]:
        """Return dead-reckoned states at the nodes, level but of arbitrary heading."""
        at_s = nodes[0][0]
        state = InertialState(
            self._samples.at(at_s), np.eye(3), np.zeros(3), np.zeros(3), self._bias, np.zeros(3)
        )
        turned, forces = [state], []
        for end_s, _ in nodes[1:]:
            samples = self._samples.between(turned[-1].stamp_s, end_s)
            forces.append(turned[-1].R_map_imu @ np.mean([s.force for s in samples], axis=0))
            turned.append(propagate_through(turned[-1], samples, 0.0))
        # Over some seconds, the mean acceleration is small beside gravity.
        level = levelled(np.mean(forces, axis=0))
        return [
            InertialState(
                state.sample,
                level @ state.R_map_imu,
                np.zeros(3),
                np.zeros(3),
                self._bias,
                np.zeros(3),
            )
            for state in turned
        ]

    def _guess(
        self,
        reckoned: Sequence[InertialState],
        nodes: Sequence[tuple[float, list[Fix]]],
        heading_rad: float,
    ) -> gtsam.Values:
        turn = from_rpy(0.0, 0.0, heading_rad)
        stamps = np.array([at_s for at_s, _ in nodes])
        attitudes = [turn @ state.R_map_imu for state in reckoned]
        positions = np.array(
            [
                np.mean([fix.p_map_antenna - R @ fix.arm_imu for fix in fixes], axis=0)
                for R, (_, fixes) in zip(attitudes, nodes, strict=True)
            ]
        )
        velocities = np.gradient(positions, stamps, axis=0)
        values = gtsam.Values()
        for i, (state, R) in enumerate(zip(reckoned, attitudes, strict=True)):
            insert(
                values,
                i,
                InertialState(
                    state.sample, R, positions[i], velocities[i], self._bias, np.zeros(3)
                ),
            )
        return values

    def _newest(
        self, solution: Solution, nodes: Sequence[tuple[float, list[Fix]]]
    ) -> tuple[InertialState, Float]:
        """Return the newest node's state and covariance, widened if the fixes fit badly."""
        last = len(nodes) - 1
        state = extract(solution.values, last, self._samples.at(nodes[-1][0]))
        ordering = gtsam.Ordering()
        for node in range(len(nodes)):
            for key in keys(node):
                ordering.push_back(key)
        # By QR: the squares of biases that hardly walk and of the other states span 16 decades.
        A, _ = solution.graph.linearize(solution.values).jacobian(ordering)
        root: Float = np.asarray(np.linalg.qr(A, mode="r"))[-DIMENSION:, -DIMENSION:]
        fixes = 3 * sum(len(fixes) for _, fixes in nodes)
        misfit = 2.0 * solution.cost / max(fixes - DIMENSION, 3)
        return state, max(misfit, 1.0) * covariance_of(root, state.R_map_imu)

    def _carried(self, state: InertialState, covariance: Float) -> tuple[InertialState, Float]:
        """Carry state and covariance on to the newest sample."""
        for sample in self._samples.between(state.stamp_s, self._samples.newest_s):
            covariance = carry_covariance(
                state, covariance, self._noise, sample.stamp_s - state.stamp_s
            )
            state = propagate(state, sample, self._noise.gravity_m_s2)
        return state, covariance
