"""The log of the truth over a world of three bodies that are moved by hand."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from executive_plugins.robot.mujoco.truth.truth_log import TruthLog

from executive.errors import DataError

WORLD = """
<mujoco><worldbody>
  <geom name="terrain" type="plane" size="9 9 1"/>
  <body name="cabin" pos="0 0 5"><freejoint/><geom size="0.1"/>
    <body name="gripper" pos="2 0 0"><geom size="0.1"/></body></body>
  <body name="stone_1" pos="1 1 1"><freejoint/><geom size="0.1"/></body>
  <body name="stone_2" pos="-1 1 1"><freejoint/><geom size="0.1"/></body>
</worldbody></mujoco>
"""
MACHINE = SimpleNamespace(links=("cabin", "gripper"), cabin_link="cabin", gripper_link="gripper")
STONE_1, STONE_2, CABIN = 7, 14, 0  # first coordinates


class Moved:
    """A world whose first stone is put where a time says, and the log of it."""

    def __init__(self) -> None:
        self.model = mujoco.MjModel.from_xml_string(WORLD)
        self.data = mujoco.MjData(self.model)
        self.log = TruthLog(MACHINE, ("stone_1", "stone_2"), self.model)

    def step(self, time_s: float, x: float = 1.0, q: tuple[float, ...] = (1, 0, 0, 0)) -> None:
        self.data.qpos[STONE_1] = x
        self.data.qpos[STONE_1 + 3 : STONE_1 + 7] = q
        self.data.qpos[CABIN + 2] = 5.0 + time_s
        mujoco.mj_forward(self.model, self.data)
        self.log.step(time_s, self.model, self.data)


@pytest.fixture
def world() -> Moved:
    return Moved()


def test_poses_are_kept_ten_times_a_second(world: Moved) -> None:
    for k in range(26):
        world.step(k * 0.01, x=1.0 + k)
    assert world.log.end_s == pytest.approx(0.2)
    assert world.log.T_world_stone(0, 0.2)[0, 3] == pytest.approx(21.0)
    assert world.log.T_world_stone(0, 0.15)[0, 3] == pytest.approx(16.0)
    assert world.log.T_world_cabin(0.05)[2, 3] == pytest.approx(5.05)
    for outside_s, x in ((-1.0, 1.0), (9.0, 21.0)):
        assert world.log.T_world_stone(0, outside_s)[0, 3] == pytest.approx(x)
    assert world.log.centroids(0.1) == pytest.approx(np.array([[11.0, 1, 1], [-1, 1, 1]]))


def test_holding_tells_height_and_distance_from_the_palm(world: Moved) -> None:
    for k in range(5):
        world.step(0.1 * k, x=2.0)
    heights, distances = world.log.holding(0, 0.1, 0.3)
    assert heights == pytest.approx([1.0, 1.0, 1.0])
    rise = 4.0 + 0.1 * np.arange(1, 4)  # of the palm, at (2, 0), over the stone, at (2, 1)
    assert distances == pytest.approx(np.hypot(1.0, rise))


def test_a_stone_rests_where_it_is_still_and_elsewhere_than_before(world: Moved) -> None:
    # At rest at 1 m, under way, still for one record at 2 m, and moved by less than a millimetre.
    for k, x in enumerate((1.0, 1.0, 1.5, 2.0, 2.0, 2.0, 2.0009, 2.0009, 2.002, 2.002)):
        world.step(0.1 * k, x=x)
    (since_s, poses), (other_s, _) = world.log.keep()
    assert since_s == pytest.approx([0.0, 0.4, 0.9])
    assert poses[:, 0, 3] == pytest.approx([1.0, 2.0, 2.002])
    assert other_s == pytest.approx([0.0])


def test_a_stone_that_turns_where_it_is_rests_anew(world: Moved) -> None:
    half = 0.05
    for k in range(4):
        turned = (np.cos(half), 0.0, 0.0, np.sin(half)) if k > 1 else (1.0, 0.0, 0.0, 0.0)
        world.step(0.1 * k, q=turned)
    since_s, poses = world.log.keep()[0]
    assert since_s == pytest.approx([0.0, 0.3])
    assert poses[1][1, 0] == pytest.approx(np.sin(2 * half))


def test_a_log_that_goes_on_knows_where_stones_lay_before(world: Moved) -> None:
    for k, x in enumerate((1.0, 1.0, 3.0, 3.0, 5.0)):
        world.step(0.1 * k, x=x)
    later = Moved()
    later.data.qpos[STONE_1] = 5.0
    mujoco.mj_forward(later.model, later.data)
    later.log.begin_at(10.0, later.model, later.data, world.log.keep())
    assert later.log.end_s == 10.0
    for time_s, x in ((-1.0, 1.0), (0.0, 1.0), (0.29, 1.0), (0.3, 3.0), (9.9, 3.0), (10.0, 5.0)):
        assert later.log.T_world_stone(0, time_s)[0, 3] == pytest.approx(x), time_s


def test_contacts_of_the_machine_are_told_as_spans(world: Moved) -> None:
    assert world.log.spans() == ()
    world.data.qpos[STONE_2 : STONE_2 + 3] = 0.0, 0.0, 5.15  # touches the cabin at 0 s alone
    world.step(0.0)
    world.step(0.1)
    (span,) = world.log.spans()
    assert (span.link, span.other, span.from_s) == ("cabin", "stone_2", 0.0)
    assert span.to_s == pytest.approx(0.1)  # the control step at whose end it was gone


def test_what_another_process_recorded_is_taken_with_times_from_its_zero(world: Moved) -> None:
    for k in range(6):
        world.step(0.1 * k, x=float(k))
    world.step(0.6, x=5.0)  # it lies
    other = Moved()
    other.step(0.0, x=-7.0)
    other.log.take(world.log.records(), 0.2)
    assert other.log.end_s == pytest.approx(0.4)
    for at_s in (-0.2, 0.0, 0.13, 0.4):
        assert other.log.centroids(at_s) == pytest.approx(world.log.centroids(at_s + 0.2))
        found, there = other.log.T_world_cabin(at_s), world.log.T_world_cabin(at_s + 0.2)
        np.testing.assert_allclose(found, there, atol=1e-12)
    heights, distances = other.log.holding(0, 0.0, 0.4)
    expected = world.log.holding(0, 0.2, 0.6)
    np.testing.assert_allclose((heights, distances), expected, atol=1e-12)
    for found, there in zip(other.log.keep(), world.log.keep(), strict=True):
        np.testing.assert_allclose(found[0], there[0] - 0.2)
        np.testing.assert_array_equal(found[1], there[1])


@pytest.mark.parametrize("name", ["stamps_s", "stone_poses", "cabin_poses", "gripper_poses"])
def test_records_that_lack_something_are_refused(world: Moved, name: str) -> None:
    world.step(0.0)
    records = dict(world.log.records())
    del records[name]
    with pytest.raises(DataError, match="incomplete"):
        world.log.take(records, 0.0)


def test_records_of_other_stones_are_refused(world: Moved) -> None:
    world.step(0.0)
    records = {**world.log.records(), "names": np.array(["stone_1", "stone_3"])}
    with pytest.raises(DataError, match="another site"):
        world.log.take(records, 0.0)
