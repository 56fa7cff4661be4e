"""A survey of a simulated site comes over the wire as a cloud, beside the machine's own life."""

import threading
import time

import numpy as np
import pytest
from executive_plugins.robot.kinematic import KinematicRobot
from executive_plugins.robot.settings import KinematicSettings, WireSettings
from executive_plugins.robot.wire import WireRobot
from executive_plugins.surveying.settings import SimulatedDroneSettings
from executive_plugins.surveying.simulated_drone import SimulatedDrone

from executive.errors import DataError
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.wire.address import Address
from executive.wire.frame import Frame, Kind, WireError
from executive.wire.machine_server import MachineServer, Simulation
from executive.wire.survey import cloud_of

LARGE = 100_000  # points: more than the buffers of a socket take at once


def survey_of(seed):
    if seed == 1:
        raise DataError("the drone saw no ground")
    if seed == 2:
        raise RuntimeError("a mistake in a plugin")
    return Cloud("survey", np.random.default_rng(seed).normal(size=(LARGE, 3)))


def serving(folder, simulation):
    robot = KinematicRobot(KinematicSettings(), load_machine("m545"))
    server = MachineServer(robot, "m545", Address(str(folder / "machine.sock")), 10.0, simulation)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    return server, thread


@pytest.fixture
def machine(tmp_path):
    server, thread = serving(tmp_path, Simulation(survey=lambda seed: lambda: survey_of(seed)))
    yield server
    server.is_ended = True
    thread.join(5)


def driver_of(server):
    return WireRobot(WireSettings(address=str(server.address), answer_limit=5, silence_limit=5))


def test_the_whole_cloud_arrives(machine):
    cloud = driver_of(machine).survey_of_site(7)
    assert cloud.frame == "survey"
    np.testing.assert_array_equal(cloud.points, survey_of(7).points)


def test_the_drone_asks_the_machine_and_need_not_see_the_site(machine):
    drone = SimulatedDrone(SimulatedDroneSettings(), driver_of(machine))
    assert drone.is_remote
    assert len(drone.survey(np.random.default_rng(3))) == LARGE


@pytest.mark.parametrize(
    ("seed", "told"), [(1, "the drone saw no ground"), (2, "RuntimeError: a mistake in a plugin")]
)
def test_a_survey_that_fails_is_told_and_the_machine_lives_on(machine, seed, told):
    with pytest.raises(DataError, match=told):
        driver_of(machine).survey_of_site(seed)
    assert len(driver_of(machine).survey_of_site(7)) == LARGE


def test_the_machine_lives_on_while_the_survey_is_made(tmp_path):
    may_end = threading.Event()

    def slow(seed):
        return lambda: may_end.wait(60) and survey_of(seed)

    server, thread = serving(tmp_path, Simulation(survey=slow))
    found = []
    asking = threading.Thread(target=lambda: found.append(driver_of(server).survey_of_site(7)))
    asking.start()
    before_s = server.time_s
    while server.time_s < before_s + 0.1:  # ends only if its clock goes on
        time.sleep(0.01)
    assert not found
    may_end.set()
    asking.join(60)
    assert len(found[0]) == LARGE
    server.is_ended = True
    thread.join(5)


def test_a_machine_without_a_survey_says_so(tmp_path):
    server, thread = serving(tmp_path, None)
    with pytest.raises(DataError, match="it makes no survey"):
        driver_of(server).survey_of_site(7)
    server.is_ended = True
    thread.join(5)


@pytest.mark.parametrize(
    "head",
    [
        {},
        {"frame": "survey", "points": {"shape": [3, 3]}},
        {"frame": 1, "points": {"shape": [2, 3]}},
    ],
)
def test_what_is_no_cloud_is_refused(head):
    with pytest.raises(WireError, match="no cloud"):
        cloud_of(Frame(Kind.CLOUD, head, bytes(48)))
