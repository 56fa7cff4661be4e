"""The procedure of the trials, in a world that answers by a rule instead of an engine.

Its stones slide by 1 m along gravity, one after another, once the slope is more than each bears.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.placing import stability_trials
from executive_plugins.placing.stability_trials import StabilityTrials

from executive.arrays import Float

STEP_S = 0.004
Y = np.array([0.0, 1.0, 0.0])
RULES = SimpleNamespace(step_s=STEP_S, friction=0.6)


class World:
    """Stones at x = 0, 1, … and given heights, each with a slope that it bears to each side [°]."""

    def __init__(self, heights, bears_deg, speed=0.0, late_s=0.0) -> None:
        n = len(heights)
        self.places = np.column_stack([np.arange(n), np.zeros(n), heights]).astype(float)
        self._bears_deg, self._speed, self._late_s = bears_deg, speed, late_s
        self.free = range(n)
        self.data = SimpleNamespace(time=0.0, xfrc_applied=np.zeros((n + 3, 6)))
        self.option = SimpleNamespace(gravity=np.array([0.0, 0.0, -9.81]))
        self.model = SimpleNamespace(opt=self.option, body=lambda name: SimpleNamespace(id=3))
        self.settled: list[tuple[float, float]] = []
        self.log: list[tuple[float, float]] = []  # tilt towards y [°] and duration [s] of a step
        self.forces: list[Float] = []
        self._tilted_s = 0.0

    def settle(self, least_s: float, most_s: float) -> None:
        self.settled.append((least_s, most_s))
        self.data.time += 0.6
        self.places = self.places + [0.0, 0.0, -0.01]

    def pose_of(self, number: int) -> Float:
        T = np.eye(4)
        T[:3, 3] = self.places[number]
        return T

    def speed(self) -> float:
        return self._speed

    def step(self, count: int) -> None:
        g = self.option.gravity
        assert np.linalg.norm(g) == pytest.approx(9.81)
        angle_deg = float(np.degrees(np.arctan2(g[1], -g[2])))
        self.log.append((round(angle_deg, 6), round(count * STEP_S, 6)))
        self.forces.append(self.data.xfrc_applied.copy())
        self.data.time += count * STEP_S
        self._tilted_s = self._tilted_s + count * STEP_S if abs(angle_deg) > 1e-6 else 0.0
        for i, bears in enumerate(self._bears_deg):
            least, most = bears if isinstance(bears, tuple) else (-bears, bears)
            if not least <= angle_deg <= most and self._tilted_s >= self._late_s:
                self.places[i, 1] += np.sign(angle_deg)
        mass = np.arange(1, len(self.places) + 1) * 100.0
        pushed = self.data.xfrc_applied[3:, :3] / mass[:, None]
        self.places = self.places + 0.05 * pushed + [0.001, 0.0, 0.0]


@pytest.fixture
def trials(monkeypatch: pytest.MonkeyPatch):
    def get(model, data, state, kind) -> None:
        state[0] = data.time
        state[1:] = data.world.places.ravel()

    def put(model, data, state, kind) -> None:
        data.time = float(state[0])
        data.world.places = state[1:].reshape(-1, 3).copy()
        data.world._tilted_s = 0.0

    def make(*given, **settings) -> StabilityTrials:
        world = World(*given, **settings)
        world.data.world = world
        n = 3 * len(world.places)
        engine = SimpleNamespace(
            mjtState=SimpleNamespace(mjSTATE_INTEGRATION="all"),
            mj_stateSize=lambda model, kind: n + 1,
            mj_getState=get,
            mj_setState=put,
        )
        monkeypatch.setattr(stability_trials, "mujoco", engine)
        monkeypatch.setattr(stability_trials, "world_of", lambda built, rules: world)
        standing = [
            SimpleNamespace(T_map_stone=world.pose_of(i), stone=SimpleNamespace(mass_kg=100.0 * m))
            for i, m in enumerate(range(1, len(world.places) + 1))
        ]
        made = StabilityTrials(SimpleNamespace(standing=standing), RULES)
        made.world = world
        return made

    return make


def test_trials_begin_at_rest(trials) -> None:
    assert trials([0.5], [9.0]).world.settled == [(0.5, 2.0)]


def test_drift_counts_from_where_stones_were_put_and_the_time_of_settling_with_it(trials) -> None:
    own = trials([0.5, 1.0], [9.0, 9.0])
    own.world.data.time = 77.0  # whatever was tried before
    assert own.drift_m(2.6) == pytest.approx(np.hypot(0.01, 0.001))
    assert own.world.log == [(0.0, 2.0)]
    own.world.places[1, 0] += 5.0
    assert own.drift_m(0.1) == pytest.approx(np.hypot(0.01, 0.001))
    assert own.world.log[1:] == [(0.0, STEP_S)]  # at least a step


@pytest.mark.parametrize(
    ("bears_deg", "expected"),
    [(5.5, 5.0), (4.5, 4.0), (4.0, 4.0), (0.5, 0.0), (1.5, 1.0), (60.0, 20.0)],
)
def test_a_tilt_is_found_to_a_degree(trials, bears_deg: float, expected: float) -> None:
    """Beginning with steps of two, and no further than asked."""
    own = trials([0.5, 1.0], [70.0, bears_deg + 1e-6])
    assert own.tilt_deg(Y, 20.0) == expected


def test_no_tilt_beyond_the_largest_is_told(trials) -> None:
    assert trials([0.5], [60.0]).tilt_deg(Y, 5.0) == 5.0
    assert trials([0.5], [60.0]).tilt_deg(Y, 0.0) == 0.0


def test_the_worse_side_counts_whichever_it_is(trials) -> None:
    assert trials([0.5], [(-3.1, 9.0)]).tilt_deg(Y, 20.0) == 3.0
    assert trials([0.5], [(-9.0, 3.1)]).tilt_deg(Y, 20.0) == 3.0


def test_a_tilt_goes_on_from_the_last_that_stood(trials) -> None:
    own = trials([0.5], [(-60.0, 3.1)])
    own.tilt_deg(Y, 4.0)
    tried = [angle for angle, _ in own.world.log]
    # Three tenths of a second each; what falls is seen at once. Then 3° from 2°, and 4° no more.
    assert tried[:8] == [2.0, 2.0, 2.0, 4.0, 3.0, 3.0, 3.0, 4.0]
    assert {seconds for _, seconds in own.world.log} == {0.1}


def test_a_tilt_is_held_while_a_stone_moves(trials) -> None:
    """Up to three seconds: a tall stone topples slowly."""
    own = trials([0.5], [60.0], speed=0.02)
    own.tilt_deg(Y, 2.0)
    assert len(own.world.log) == 2 * 30
    slow = trials([0.5], [3.1], speed=0.02, late_s=2.5)
    assert slow.tilt_deg(Y, 8.0) == 3.0
    hurried = trials([0.5], [3.1], speed=0.009, late_s=2.5)
    assert hurried.tilt_deg(Y, 8.0) == 8.0


def test_the_upper_quarter_is_pushed_by_a_fifth_of_its_weight(trials) -> None:
    own = trials([0.5, 0.9, 0.5, 0.5, 0.6], [60.0] * 5)
    moved = own.pushed_m(Y)
    pushing, after = own.world.forces
    # The upper quarter of five are those from the second highest on: numbers 1 and 4.
    expected = np.zeros((8, 6))
    expected[3 + 1, 1], expected[3 + 4, 1] = 0.2 * 9.81 * 200.0, 0.2 * 9.81 * 500.0
    assert pushing == pytest.approx(expected)
    assert not after.any()
    assert own.world.log == [(0.0, 0.3), (0.0, 2.0)]
    assert moved == pytest.approx(np.hypot(0.05 * 0.2 * 9.81, 0.002))


def test_a_stone_below_that_moves_is_no_top_stone(trials) -> None:
    own = trials([0.5, 0.9], [60.0] * 2)
    own._rest[2] += 5.0  # the lower one lies elsewhere than it did
    assert own.pushed_m(Y) == pytest.approx(np.hypot(0.05 * 0.2 * 9.81, 0.002))


def test_the_load_is_the_smaller_of_both_sides(trials, monkeypatch) -> None:
    asked = []

    def largest(touches, places, masses, friction, towards):
        asked.append((touches, places.tolist(), masses.tolist(), friction, towards.tolist()))
        return bears[tuple(towards)]

    monkeypatch.setattr(stability_trials, "largest_load", largest)
    monkeypatch.setattr(stability_trials, "touches_of", lambda world, within_m: "touches")
    own = trials([0.5, 1.0], [60.0] * 2)
    bears = {(0.0, 1.0, 0.0): 0.5, (0.0, -1.0, 0.0): 0.4}
    assert own.load(Y) == 0.4
    places = [[0.0, 0.0, 0.49], [1.0, 0.0, 0.99]]
    assert asked == [
        ("touches", places, [100.0, 200.0], 0.6, [0.0, sign, 0.0]) for sign in (1.0, -1.0)
    ]
    bears[(0.0, -1.0, 0.0)] = None
    assert own.load(Y) is None
    bears[(0.0, 1.0, 0.0)] = None
    assert own.load(Y) is None
