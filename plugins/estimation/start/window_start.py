"""The first state of a body that moves: its newest seconds as one problem, from several headings.

Source: the start of Nubert 2025 (arXiv 2504.06479), a prior of 180 deg in heading and 10 m/s in
velocity instead of a rest. Deviation: a heading is not taken from one linearisation; the problem
is solved from several, and what they leave open is part of the covariance.
"""

from collections import deque
from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from executive_plugins.estimation.factors import covariance_of, extract
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    Inertial,
    stepped,
)
from executive_plugins.estimation.start.fix_groups import grouped, longest_straight_s
from executive_plugins.estimation.start.found import Found
from executive_plugins.estimation.start.heading_hypotheses import Hypothesis, most_likely
from executive_plugins.estimation.start.settings import WindowStartSettings
from executive_plugins.estimation.start.window_problem import (
    CLOCK,
    Knowledge,
    WindowProblem,
    misfit,
)
from executive_plugins.estimation.start.window_solution import Solution

from executive.arrays import Float
from executive.geometry.rotation import wrap_angle

_NODES = 30  # at most, in a window
_HEADINGS = 4  # first guesses; the basin of attraction is wider than a quarter of a turn
_STEP_S = 0.05  # between two steps of an attempt
_CLOCK_GUESS = (
    1.5  # first guesses of the clock, in standard deviations, if the present one fits badly
)
_GROWTH = 1.25  # of the window, from one attempt to the next
_SHARE = 0.1  # of the longest window, at most
_FIRST_SPAN_S = 0.8
# A window is solved again if the fixes scatter by more than was assumed, by this factor on their
# variance: the 99 % bound of a median of 30.
_RESCALED = 1.6

_Nodes = list[tuple[float, list[Fix]]]


@dataclass(frozen=True, slots=True, eq=False)
class _Trial:
    """The solutions of a window from one first guess of the receiver's clock."""

    late_s: float
    nodes: _Nodes
    problem: WindowProblem
    solutions: list[Solution]
    hypotheses: list[Hypothesis]

    @property
    def cost(self) -> float:
        """Cost of the likeliest solution; inf if there is none."""
        return min((one.cost for one in self.solutions), default=np.inf)

    @property
    def scatter(self) -> float:
        """Factor on the fixes' variance that explains the likeliest; 1 if there is none."""
        likeliest = min(self.hypotheses, key=lambda one: one.cost, default=None)
        return 1.0 if likeliest is None else likeliest.fix_scale


class WindowStart:
    """Collects samples and fixes, and solves for the motion that explains them.

    Nothing need be at rest, and the first heading is unknown. The heading follows from two
    antennas, or from the difference of the accelerations by the fixes and by the samples.

    Attributes:
        waits_for: Why there is no state with a heading yet; empty before the first attempt.
    """

    def __init__(
        self, settings: WindowStartSettings, noise: InertialNoise, clock_std_s: float = 0.0
    ) -> None:
        """Make an empty window.

        Args:
            settings: Its length, and when a heading is known.
            noise: Noise of the inertial sensor.
            clock_std_s: Standard deviation of the receiver's clock against the inertial sensor's
                [s]; 0 if they agree.
        """
        self._settings, self._noise, self._clock_std_s = settings, noise, clock_std_s
        self._samples = SampleBuffer()
        self._fixes: deque[Fix] = deque()
        self._first_s: float | None = None  # of the samples
        self._next_span_s = _FIRST_SPAN_S
        self._tried_s = self._stepped_s = -np.inf
        self._attempt: Generator[None, None, Found | None] | None = None
        # By the newest attempt, for the next: gyro bias, clock, and factor on the fixes' variance.
        self._bias, self._late_s, self._fix_scale = np.zeros(3), 0.0, 1.0
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
        if std_rad_s < self._noise.gyro_bias_rad_s:
            self._rest_bias, self._rest_std_rad_s = gyro_bias, std_rad_s

    def state(self) -> Found | None:
        """Return the state at the newest sample, if an attempt has just found one.

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
            found: Found | None = end.value
            return None if found is None else self._carried(found)
        return None

    def _is_due(self) -> bool:
        """Return whether the window has grown enough since the last attempt."""
        if not self._fixes:
            self.waits_for = "fixes"
            return False
        span_s = self._fixes[-1].stamp_s - self._fixes[0].stamp_s
        now_s = self._fixes[-1].stamp_s
        is_full = span_s >= 0.9 * self._settings.window_s
        wait_s = _SHARE * self._settings.window_s if is_full else 0.0
        if now_s - self._tried_s < wait_s or (not is_full and span_s < self._next_span_s):
            return False
        self._tried_s = now_s
        step_s = min((_GROWTH - 1.0) * span_s, _SHARE * self._settings.window_s)
        self._next_span_s = max(span_s + step_s, _FIRST_SPAN_S)
        return True

    def _steps(self) -> Generator[None, None, Found | None]:
        """Solve from one heading after the other; return what they say of the newest node."""
        best = yield from self._solved_at(self._late_s)
        if best is None:
            self.waits_for = "fixes: fewer than two times so far"
            return None
        if best.scatter > _RESCALED * self._fix_scale:
            for late_s in self._other_clocks():
                other = yield from self._solved_at(late_s)
                if other is not None and other.cost < best.cost:
                    best = other
        self._late_s = best.late_s
        held = []
        if best.solutions:
            likeliest = min(best.solutions, key=lambda one: one.cost)
            for k in range(1, _HEADINGS):
                yield
                turn_rad = wrap_angle(2 * np.pi * k / _HEADINGS)
                turned = best.problem.held(likeliest, turn_rad)
                if turned is not None:
                    held.append((turn_rad, turned.cost - likeliest.cost))
        yield
        return self._judged(best.hypotheses, held, best.nodes)

    def _other_clocks(self) -> list[float]:
        """Return first guesses of the clock that are far from the present one [s].

        A body that walks or shakes is as it was one period ago: a clock that is off by a part of
        one is another solution, and a bad one. It is taken for noise unless others are tried.
        """
        std_s = self._clock_std_s
        guesses = (-_CLOCK_GUESS * std_s, 0.0, _CLOCK_GUESS * std_s)
        return [one for one in guesses if abs(one - self._late_s) > 0.5 * std_s]

    def _solved_at(self, late_s: float) -> Generator[None, None, _Trial | None]:
        """Solve from each heading for stamps that are late by a time; None for too few fixes."""
        self._late_s = late_s
        nodes = self._nodes()
        if len(nodes) < 2:
            return None
        known = Knowledge(
            self._rest_bias, self._rest_std_rad_s, self._bias, late_s, self._clock_std_s
        )
        problem = WindowProblem(nodes, self._samples, self._noise, known)
        solutions = []
        for k in range(_HEADINGS):
            yield
            solution = problem.solved(2 * np.pi * k / _HEADINGS)
            if solution is not None:
                solutions.append(solution)
        hypotheses = [self._hypothesis(one, problem, nodes) for one in solutions]
        return _Trial(late_s, nodes, problem, solutions, hypotheses)

    def _judged(
        self, hypotheses: list[Hypothesis], held: Sequence[tuple[float, float]], nodes: _Nodes
    ) -> Found | None:
        """Return the likeliest state, with all other headings that are likely in its covariance.

        None if clock or accuracy of the receiver are so different from what was assumed that the
        problem must be solved again.
        """
        if not hypotheses:
            self.waits_for = "fixes that fit the inertial samples"
            return None
        found, headings, std_rad = most_likely(hypotheses, held, self._settings.max_heading_std_rad)
        moved_s, self._late_s = abs(found.clock.offset_s - self._late_s), found.clock.offset_s
        self._bias, self.waits_for = found.state.gyro_bias, ""
        is_curved = self._clock_std_s > 0 and moved_s > longest_straight_s(nodes[-1][1][0])
        is_noisier = found.fix_scale > _RESCALED * self._fix_scale
        self._fix_scale = found.fix_scale
        if is_curved or is_noisier:
            self._tried_s, self._next_span_s = -np.inf, 0.0
            self.waits_for = "the receiver's clock and accuracy"
            return None
        if not found.has_heading:
            which = (
                f"{headings} headings explain all fixes"
                if headings > 1
                else f"its standard deviation is {std_rad:.2f} rad"
            )
            self.waits_for = f"motion that tells the heading: {which}"
        return found

    def _nodes(self) -> _Nodes:
        """Return times of the window with their fixes, oldest first, at most `_NODES`."""
        by_time: dict[float, list[Fix]] = {}
        oldest_s = max(self._first_s or 0.0, self._samples.oldest_s)
        for fix in sorted(self._fixes, key=lambda fix: fix.stamp_s):
            at_s = fix.stamp_s - self._late_s
            if oldest_s <= at_s <= self._samples.newest_s:
                scaled = replace(fix, covariance=self._fix_scale * fix.covariance)
                by_time.setdefault(at_s, []).append(scaled)
        return grouped(by_time, _NODES)

    def _hypothesis(self, solution: Solution, problem: WindowProblem, nodes: _Nodes) -> Hypothesis:
        """Return the newest node's state and covariance."""
        last = len(nodes) - 1
        state = extract(solution.values, last, self._samples.at(nodes[-1][0]))
        # By QR: the squares of biases that hardly walk and of the other states span 16 decades.
        A, _ = solution.graph.linearize(solution.values).jacobian(problem.ordering())
        n = DIMENSION + (self._clock_std_s > 0)
        root = np.asarray(np.linalg.qr(A, mode="r"))
        P = covariance_of(root[-n:, -n:], state.R_map_imu)
        clock = ClockOffset()
        if n > DIMENSION:
            late_s = self._late_s + float(solution.values.atVector(CLOCK)[0])
            clock = ClockOffset(late_s, float(np.sqrt(P[-1, -1])), P[:DIMENSION, -1])
        squares, free = problem.residuals2(solution), problem.free(A, root)
        scale = max(1.0, self._fix_scale * misfit(squares, free, n))
        return Hypothesis(solution.cost, state, P[:DIMENSION, :DIMENSION], clock, scale)

    def _carried(self, found: Found) -> Found:
        """Carry state and covariance on to the newest sample."""
        state, covariance, cross = found.state, found.covariance, found.clock.cross[:, None]
        for sample in self._samples.between(state.stamp_s, self._samples.newest_s):
            state, covariance, cross = stepped(state, covariance, cross, sample, self._noise)
        clock = ClockOffset(found.clock.offset_s, found.clock.std_s, cross[:, 0])
        return replace(found, state=state, covariance=covariance, clock=clock)
