"""The plan of all sampling planners with parts that answer by a table: order, refusals, stops."""

from collections import Counter
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.grasping import sampled_planner
from executive_plugins.grasping.rehearsal import HELD, Rehearsed
from executive_plugins.grasping.sampled_planner import Order, SampledPlanner
from executive_plugins.grasping.sampling.pool import Pool

from executive.errors import DataError
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone, StoneState
from executive.messages.weight import Weight

UP = np.array([0.0, 0.0, 1.0])
T_MAP_BASE = pose(t=np.array([7.0, 8.0, 9.0]))
T_MAP_PLAN = pose(about_axis(UP, 0.5), np.array([1.0, 2.0, 3.0]))
GRIPPER = SimpleNamespace(max_opening_m=1.2)
SCENE = SimpleNamespace(
    volume_m3=0.5,
    least_width_m=0.8,
    body=lambda foot: f"body on a foot of {foot}",
    points="points",
    T_map_plan=T_MAP_PLAN,
    ground=SimpleNamespace(normal=UP),
)


def stone(points: int = 20, weight: Weight | None = None) -> Stone:
    zero = np.zeros(3)
    return Stone(1, next(iter(StoneState)), np.zeros((points, 3)), zero, np.eye(4), False, weight)


def pool(
    count: int = 6, refused: Counter[str] | None = None, held_before: dict[int, int] | None = None
) -> Pool:
    """Return grasps one metre from each other, whose cost is their number."""
    position = np.column_stack([np.arange(count), np.zeros((count, 2))]).astype(float)
    costs = {"align_rad": np.arange(count) / 10, "shallow_m": np.arange(count) / -20}
    refused = Counter() if refused is None else refused
    times_held = np.array([(held_before or {}).get(i, 0) for i in range(count)])
    R, jaw_rad = np.array([np.eye(3)] * count), np.arange(count) / 100
    return Pool(R, position, jaw_rad, costs, refused, times_held)


@dataclass
class Seen:
    """What came of a lift."""

    slip_m: float
    push_m: float = 0.01

    def joined(self, other: Rehearsed, times: int) -> "Seen":
        assert other is HELD
        return Seen(self.slip_m / 10**times, self.push_m)


class Rehearsal:
    """Lifts that slip as a table says, by the number of the grasp."""

    feet = (1.0, 0.5)

    def __init__(self, slips_m: dict[int, float], again_m: dict[int, float] | None = None) -> None:
        self.slips_m, self.again_m, self.asked = slips_m, again_m or {}, []
        self.confirmed_ones: list[int] = []

    def lift(self, simulated, T_plan_gripper, jaw_rad, predicted, to_beat) -> Seen:
        assert simulated == {
            foot: (GRIPPER, f"body on a foot of {foot}", UP.tolist(), 1200.0) for foot in self.feet
        }
        number = round(jaw_rad * 100)
        assert T_plan_gripper[:3, 3].tolist() == [number, 0.0, 0.0]
        self.asked.append((number, predicted, to_beat))
        return Seen(self.slips_m.get(number, 0.0))

    def confirmed(self, simulated, T_plan_gripper, jaw_rad, depth_m, seen) -> Seen:
        number = round(jaw_rad * 100)
        assert len(simulated) == len(self.feet)
        assert T_plan_gripper[:3, 3].tolist() == [number, 0.0, 0.0]
        assert depth_m == pytest.approx(number / 20)
        assert seen.slip_m == self.slips_m.get(number, 0.0)
        self.confirmed_ones.append(number)
        return Seen(self.again_m.get(number, seen.slip_m))

    def highest(self, worth: float) -> float:
        return worth + 0.5

    def score(self, worth: float, is_telling: bool, seen: Seen) -> float:
        return (worth if is_telling else 0.0) - seen.slip_m

    def rate_of(self, score: float) -> float | None:
        return min(max(score / 2, 0.0), 1.0)

    def is_firm(self, seen: Seen) -> bool:
        return seen.slip_m == 0.0

    def slips(self, seen: Seen, most_m: float) -> bool:
        return seen.slip_m > most_m


class Planner(SampledPlanner):
    """A planner whose parts are given."""

    def __init__(self, given: Pool, order: Order | None = None, **settings: object) -> None:
        known = {
            "density": 2400.0,
            "overload": 1.5,
            "rehearsed": 6,
            "max_grasps": 10,
            "max_slip_m": 0.2,
            "scale": 2.0,
            "approach_m": 0.4,
            "lift_capacity": "a rule",
        }
        self._settings = SimpleNamespace(**known | settings)
        self._machine = SimpleNamespace(
            payload_kg=1000.0,
            gripper=GRIPPER,
            stance=SimpleNamespace(limits_by_tipping=lambda rule: rule == "by tipping"),
        )
        self._sampler = SimpleNamespace(
            scenes=lambda points, around, rng: [SCENE],
            pool=lambda scene, rng, known: given,
        )
        self._rehearsal = Rehearsal({})
        self._arm = SimpleNamespace(
            reached=lambda T, T_map_base, approach_m: T,
            holds=lambda T, T_map_base, mass_kg: True,
            refusal=lambda T, T_map_base, mass_kg: "",
        )
        n = len(given)
        self._order = order or Order(range(n), np.linspace(0.9, 0.8, n), {"own": np.ones(n)}, True)

    def ordered(self, scene, given) -> Order:
        return self._order


@pytest.fixture(autouse=True)
def free(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """Make all paths free, and keep what is asked; numbers may be put into the sets."""
    own = SimpleNamespace(blocked=set(), inside=set(), asked=[])

    class ApproachPath:
        def __init__(self, gripper, scale) -> None:
            assert (gripper, scale) == (GRIPPER, 2.0)

        def is_free(self, points, T, up, approach_m, room_m) -> bool:
            own.asked.append((points, up.tolist(), approach_m, room_m))
            return T[0, 3] not in own.blocked

    class FclCheck:
        def __init__(self, gripper, room_m) -> None:
            assert (gripper, room_m) == (GRIPPER, 0.02)

        def is_free(self, points, T) -> bool:
            return T[0, 3] not in own.inside

    monkeypatch.setattr(sampled_planner, "ApproachPath", ApproachPath)
    monkeypatch.setattr(sampled_planner, "FclCheck", FclCheck)
    monkeypatch.setattr(
        sampled_planner,
        "SimulatedLift",
        lambda gripper, body, normal, mass_kg: (gripper, body, normal.tolist(), mass_kg),
    )
    return own


def plan(planner: Planner, target: Stone | None = None, frame: str = "map"):
    cloud = Cloud(frame, np.zeros((1, 3)))
    return planner.plan(target or stone(), cloud, T_MAP_BASE, np.random.default_rng(0))


def numbers(found) -> list[int]:
    """Return which grasps of the pool a plan holds."""
    return [round(grasp.costs["align_rad"] * 10) for grasp in found.grasps]


def test_a_cloud_elsewhere_and_a_stone_of_few_points_are_refused() -> None:
    with pytest.raises(DataError, match="needs a cloud in the frame 'map', got 'base'"):
        plan(Planner(pool()), frame="base")
    found = plan(Planner(pool()), stone(points=19))
    assert (found.grasps, found.refused, found.is_final) == ((), {"too_few_points": 1}, False)
    assert plan(Planner(pool()), stone(points=20)).grasps


def test_a_stone_that_is_too_heavy_for_sure_is_refused_for_good() -> None:
    """By its volume it weighs 1.2 t, two thirds of it at least; weighed, two deviations less."""
    assert plan(Planner(pool())).grasps
    heavy = plan(Planner(pool(), overload=1.19))
    assert (heavy.grasps, heavy.refused, heavy.is_final) == ((), {"too_heavy": 1}, True)
    assert heavy.detail == "1200 kg by its volume, not weighed, and the gripper lifts 1000 kg"
    weighed = plan(Planner(pool()), stone(weight=Weight(1201.0, 100.0)))
    assert weighed.is_final
    assert weighed.detail == "weighed: 1201 ± 100 kg, and the gripper lifts 1000 kg"
    planner = Planner(pool(), rehearsed=0)
    assert plan(planner, stone(weight=Weight(1200.0, 100.0))).grasps


def test_a_stone_wider_than_the_jaws_is_refused_for_now(monkeypatch) -> None:
    monkeypatch.setattr(SCENE, "least_width_m", 1.21)
    found = plan(Planner(pool()))
    assert (found.grasps, found.refused, found.is_final) == ((), {"wider_than_opening": 1}, False)
    assert found.detail == "1.21 m wide, and the jaws open to 1.20 m"
    monkeypatch.setattr(SCENE, "least_width_m", 1.2)
    assert plan(Planner(pool())).grasps


def test_an_empty_pool_tells_why_by_reason() -> None:
    found = plan(Planner(pool(0, Counter(tips=3, palm=4, none=0))))
    assert (found.grasps, list(found.refused.items())) == ((), [("palm", 4), ("tips", 3)])


def test_grasps_have_their_pose_score_and_costs_best_first() -> None:
    order = Order([2, 0, 1], np.array([0.5, 0.7, 0.6]), {"own": np.array([4.0, 5.0, 6.0])}, True)
    planner = Planner(pool(3), order)
    planner._rehearsal = Rehearsal({1: 0.05})
    found = plan(planner)
    assert numbers(found) == [1, 2, 0]
    assert [grasp.score for grasp in found.grasps] == pytest.approx([0.65, 0.6, 0.5])
    assert [grasp.hold_rate for grasp in found.grasps] == pytest.approx([0.325, 0.3, 0.25])
    best = found.grasps[0]
    assert best.T_map_gripper == pytest.approx(T_MAP_PLAN @ pose(t=np.array([1.0, 0.0, 0.0])))
    assert best.opening_m == 1.2
    assert best.costs == {
        "align_rad": 0.1,
        "shallow_m": -0.05,
        "own": 5.0,
        "slip_m": 0.05,
        "push_m": 0.01,
    }
    # Each lift is told what is predicted and what there is to beat.
    expected = [(2, 0.6, -np.inf), (0, 0.5, 0.6), (1, 0.7, 0.6)]
    assert [(i, pytest.approx(p), pytest.approx(b)) for i, p, b in planner._rehearsal.asked] == [
        (i, p, b) for i, p, b in expected
    ]


def test_what_held_the_stone_before_comes_first_and_that_counts_as_lifts() -> None:
    """Of two grasps that slip alike in their lifts, the one that has held the stone is better."""
    planner = Planner(pool(4, held_before={2: 1}))
    planner._rehearsal = Rehearsal(dict.fromkeys(range(4), 0.1))
    assert numbers(plan(planner))[0] == 2
    assert [number for number, *_ in planner._rehearsal.asked] == [2, 0, 1, 3]
    planner._rehearsal = Rehearsal(
        {2: 2.0}
    )  # a tenth of it is left, which is as much as is allowed
    assert numbers(plan(planner)) == [0, 1, 3, 2]
    planner._rehearsal = Rehearsal({2: 2.1})
    found = plan(planner)
    assert (numbers(found), found.refused) == ([0, 1, 3], {"slips": 1})
    planner = Planner(pool(4, held_before={2: 2}))
    planner._rehearsal = Rehearsal({2: 2.1})
    assert numbers(plan(planner)) == [0, 1, 2, 3]  # held twice, a hundredth is left


def test_what_slips_too_far_or_is_unlikely_is_refused() -> None:
    order = Order(range(4), np.array([0.9, 0.8, 0.7, 0.6]), {}, True, least_score=0.6)
    planner = Planner(pool(4), order)
    planner._rehearsal = Rehearsal({0: 0.21, 1: 0.2, 2: 0.11})
    found = plan(planner)
    assert numbers(found) == [1, 3]  # 0.8 less 0.2, and 0.6 itself
    assert found.refused == {"slips": 1, "unlikely": 1}


def test_the_best_is_confirmed_until_the_best_one_was() -> None:
    """Raised lifts take 0.15 of the first one's score, so the second is lifted again, and holds."""
    order = Order(range(4), np.array([0.9, 0.8, 0.7, 0.3]), {}, True)
    planner = Planner(pool(4), order)
    planner._rehearsal = Rehearsal({}, {0: 0.15, 2: 0.19})
    found = plan(planner)
    assert planner._rehearsal.confirmed_ones == [0, 1]
    assert numbers(found) == [1, 0, 2, 3]
    assert [grasp.score for grasp in found.grasps] == pytest.approx([0.8, 0.75, 0.7, 0.3])
    assert found.grasps[1].costs["slip_m"] == 0.15


def test_what_is_unlikely_once_it_was_lifted_again_is_refused() -> None:
    order = Order(range(2), np.array([0.9, 0.7]), {}, True, least_score=0.6)
    planner = Planner(pool(2), order)
    planner._rehearsal = Rehearsal({}, {0: 0.4, 1: 0.2})
    found = plan(planner)
    assert planner._rehearsal.confirmed_ones == [0, 1]
    assert (found.grasps, found.refused) == ((), {"unlikely": 2})


def test_without_rehearsals_the_worth_is_the_score() -> None:
    order = Order(range(4), np.array([0.1, 0.4, 0.3, 0.2]), {}, True, least_score=0.15)
    found = plan(Planner(pool(4), order, rehearsed=0, max_grasps=3))
    assert numbers(found) == [1, 2]  # three are tried, and the first is unlikely
    assert found.refused == {"unlikely": 1}
    assert found.grasps[0].costs == {"align_rad": 0.1, "shallow_m": -0.05}
    assert found.grasps[0].hold_rate is None


def test_lifts_end_once_four_are_firm_and_none_can_become_the_best() -> None:
    worth = np.array([0.9, 0.8, 0.7, 0.6, 0.41, 0.39, 0.29])
    planner = Planner(pool(7), Order(range(7), worth, {}, True), rehearsed=20)
    assert numbers(plan(planner)) == [0, 1, 2, 3, 4]
    planner._rehearsal = Rehearsal({0: 0.1})  # 0.8 is to beat
    assert numbers(plan(planner)) == [0, 1, 2, 3, 4, 5]
    planner._rehearsal = Rehearsal(dict.fromkeys(range(4), 0.01))  # three are firm in the end
    assert numbers(plan(planner)) == list(range(7))


def test_a_worth_that_tells_nothing_is_not_waited_for() -> None:
    """Four firm ones end the lifts, and equal scores keep their order."""
    order = Order([5, 0, 4, 1, 3, 2], np.arange(6.0), {}, False)
    planner = Planner(pool(6), order)
    planner._rehearsal = Rehearsal({0: 0.1})
    found = plan(planner)
    assert numbers(found) == [5, 4, 1, 3, 0]
    assert [predicted for _, predicted, _ in planner._rehearsal.asked] == [None] * 5
    assert planner._rehearsal.confirmed_ones == []


def test_no_more_are_lifted_or_returned_than_the_settings_say() -> None:
    order = Order(range(6), np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]), {}, True)
    assert numbers(plan(Planner(pool(6), order, rehearsed=3))) == [2, 1, 0]
    assert numbers(plan(Planner(pool(6), order, max_grasps=2))) == [5, 4]


def test_grasps_that_are_alike_come_after_those_that_differ() -> None:
    """20 cm or 20° apart on a machine of twice the size."""
    near = pool(6)
    near.position[1] = [0.19, 0.0, 0.0]
    near.position[2] = [0.21, 0.0, 0.0]
    near.R[3:5] = about_axis(UP, np.radians(21.0)), about_axis(UP, np.radians(19.0))
    near.position[3:5] = 0.0
    planner = Planner(near, rehearsed=0, max_grasps=20)
    asked = [i for i, _ in planner._attainable(SCENE, near, range(6), T_MAP_BASE, *LOAD)]
    assert asked == [0, 2, 3, 5, 1, 4]


LOAD = (SimpleNamespace(least_kg=800.0, mass_kg=1200.0), Counter())


def test_each_grasp_is_refused_for_the_first_reason_that_holds(free) -> None:
    given = []

    def only(number: int, name: str, otherwise: object):
        def answer(T, T_map_base, figure):
            at = round(float(np.linalg.norm(T[:3, 3] - T_MAP_PLAN[:3, 3])))
            given.append((name, at, T_map_base is not None, figure))
            return otherwise if at == number else (T if name == "reached" else name == "holds")

        return answer

    planner = Planner(pool(7), rehearsed=0, lift_capacity="by tipping")
    planner._arm = SimpleNamespace(
        reached=only(0, "reached", None),
        holds=only(1, "holds", False),
        refusal=only(2, "refusal", "as it would tip by figures"),
    )
    free.blocked, free.inside = {0.0, 1.0, 2.0, 3.0}, {3.0, 4.0}
    found = plan(planner)
    assert numbers(found) == [5, 6]
    assert found.refused == {
        "approach_blocked": 1,
        "beyond_lift_capacity": 1,
        "gripper_in_cloud": 1,
        "out_of_reach": 1,
        "too_heavy_at_radius": 1,
    }
    assert found.detail == "as it would tip by figures"
    assert {(name, round(figure, 6)) for name, _, _, figure in given} == {
        ("reached", 0.8),
        ("holds", 800.0),
        ("refusal", 800.0),
    }
    assert free.asked[0] == ("points", UP.tolist(), 0.8, 0.02)
    # Where tipping limits nothing, nobody asks for it.
    planner._settings.lift_capacity = "another rule"
    given.clear()
    assert "beyond_lift_capacity" not in plan(planner).refused
    assert "refusal" not in {name for name, *_ in given}


def test_the_first_figures_of_a_refusal_are_told() -> None:
    planner = Planner(pool(3), rehearsed=0, lift_capacity="by tipping")
    planner._arm.refusal = lambda T, T_map_base, mass_kg: f"at {T[0, 3] - T_MAP_PLAN[0, 3]:.2f}"
    found = plan(planner)
    assert found.refused == {"beyond_lift_capacity": 3}
    assert found.detail == "at 0.00"


def test_the_papers_order_goes_by_stages_and_then_by_distance() -> None:
    given = pool(4)
    given.costs["align_rad"][:] = [0.4, 0.1, 0.2, 0.3]
    given.costs["enclose_m"] = np.array([0.0, 0.4, 0.1, 0.2])
    given.costs["distance_m"] = np.array([0.1, 0.2, 0.4, 0.3])
    planner = Planner(given, keep_aligned=3, keep_enclosing=2)
    # The best aligned three are 1, 2 and 3; of them 2 and 3 enclose best, 3 is the nearer one.
    assert list(planner.paper_order(given))[:2] == [3, 2]
    assert sorted(planner.paper_order(given)) == [0, 1, 2, 3]
