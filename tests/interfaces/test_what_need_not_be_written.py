"""What an interface answers for an author who writes only what he must."""

import math
from typing import Any, TypeVar

import numpy as np
import pytest

from executive.errors import ConfigError
from executive.interfaces.estimation import Estimator
from executive.interfaces.mapping import Mapper
from executive.interfaces.metric import Metric
from executive.interfaces.monitoring import Monitor
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.odometry import LidarOdometry
from executive.interfaces.plugin import Plugin
from executive.interfaces.recorded_log import LogPlugin
from executive.interfaces.registration import Registrar
from executive.interfaces.robot import Robot, RobotSettings
from executive.interfaces.surveying import Survey
from executive.interfaces.viewing import Viewer
from executive.interfaces.work import Work
from executive.leaf.action import Leaf
from executive.messages.cloud import Cloud

Interface = TypeVar("Interface")
ANY: Any = None  # an argument that the default does not read


def least(interface: type[Interface]) -> Interface:
    """Return an object of a class that has every method that must be written, and no other."""
    written = getattr(interface, "__abstractmethods__", ())
    return type("Least", (interface,), dict.fromkeys(written, lambda *given: given[1:]))()


@pytest.mark.parametrize("interface", [Estimator, Mapper, Monitor, Robot, Survey, Viewer])
def test_a_plugin_keeps_nothing(interface: type[Plugin]) -> None:
    assert least(interface).keep() == {}


def test_an_estimator_tells_nothing_that_it_does_not_know() -> None:
    estimator = least(Estimator)
    assert (estimator.account(), estimator.imu, estimator.refused) == ((), None, {})
    assert estimator.map_origin is None


def test_a_mapper_sees_nothing_in_the_jaws() -> None:
    held = least(Mapper).held()
    assert (held.frame, held.points.shape) == ("gripper", (0, 3))


def test_a_mapper_tells_of_nothing_that_moves() -> None:
    assert not least(Mapper).moving().hold(np.zeros((4, 3))).any()


def test_a_monitor_measures_nothing() -> None:
    monitor = least(Monitor)
    assert (monitor.payload_kg(ANY), monitor.weight(), monitor.standing()) == (None, None, None)


def test_a_planner_of_motions_refuses_postures_and_names_itself() -> None:
    plan = least(MotionPlanner).move_joints(ANY)
    assert plan.trajectory is None
    assert plan.reason == "Least plans no motion to joint positions"
    assert plan.path_map.shape == (0, 3)


def test_a_database_that_keeps_no_weights_returns_the_stone_as_it_is() -> None:
    assert least(ObjectDatabase).weigh(7, ANY, 3.0) == (7,)


def test_a_log_and_an_odometry_ask_for_no_settings() -> None:
    assert least(LogPlugin).settings_for(ANY) == {}
    assert least(LogPlugin).datum is None
    assert least(LidarOdometry).settings_for(["lidar"]) == {}


def test_a_method_that_registers_maps_refuses_a_single_object() -> None:
    cloud = Cloud("map", np.zeros((3, 3)))
    answer = least(Registrar).find(cloud, cloud)
    assert (answer.accepted, answer.rmse_m, answer.overlap) == (False, 0.0, 0.0)
    assert "not single objects" in answer.reason
    assert np.array_equal(answer.T_target_source, np.eye(4))


def test_a_robot_stands_still_keeps_mission_time_and_has_no_address() -> None:
    assert not RobotSettings().is_simulated  # it moves something
    robot = least(Robot)
    assert (robot.lacks, robot.has_own_clock, robot.is_ideal) == (frozenset(), False, False)
    assert (robot.behind_s(), robot.latest_s(), robot.zero_s()) == (0.0, math.inf, 0.0)
    assert (robot.taken_up_s(12.5), robot.address()) == (12.5, "")
    assert RobotSettings().may_tip is False


def test_a_survey_has_no_figures_and_a_work_no_inputs() -> None:
    assert least(Survey).account() == {}
    assert least(Work).inputs(ANY) == {}


def test_a_viewer_that_shows_nothing_live_says_what_to_choose() -> None:
    with pytest.raises(ConfigError, match=r"plugin Least shows nothing live; choose --set viewing"):
        least(Viewer).show_live(9876)


def test_a_plugin_is_one_with_a_state_of_this_process_unless_it_says_otherwise() -> None:
    plugin = least(Plugin)
    assert (plugin.is_plural, plugin.is_stateless, plugin.is_remote) == (False, False, False)


def test_a_metric_measures_values_of_which_more_is_better_unless_it_says_otherwise() -> None:
    metric = least(Metric)
    assert (metric.is_share, metric.is_more_better) == (False, True)


def test_what_a_leaf_commands_can_be_taken_back_unless_it_says_otherwise() -> None:
    assert not Leaf.is_irreversible
    assert (Leaf.claims, Leaf.on_resume, Leaf.needs) == (None, None, ())
