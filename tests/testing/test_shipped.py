"""Everything that ships passes the kit; inputs are thinned where a plugin takes long."""

import inspect
import threading
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import numpy as np
import pytest
from executive_plugins.robot.kinematic import KinematicRobot
from executive_plugins.robot.settings import KinematicSettings
from PIL import Image

from executive import registry
from executive.clouds.ply_writer import write_parts
from executive.machine.machine import load_machine
from executive.testing.exercises.segmentation import site
from executive.testing.finding import Outcome
from executive.testing.run import Trial, hold_to_contract
from executive.wire.address import Address
from executive.wire.machine_server import MachineServer

# Fewer stones, grasps and lidar returns cost less; what is checked is the same.
THINNED = {
    ("robot", "mujoco"): ("robot.site.stones.count=1",),
    ("surveying", "simulated_photographs"): (
        "surveying.flight.strips=2",
        "surveying.flight.pictures=3",
        "surveying.flight.size_px=[64, 48]",
    ),
    ("grasping", "sampled_antipodal"): ("grasping.samples=60",),
    ("grasping", "sampled_cnn"): ("grasping.samples=60", "grasping.rehearsed=1"),
}
# The fast lane runs these; the others take seconds each.
FAST = {"alignment", "monitoring", "objects", "odometry", "viewing"}
# A survey needs something to survey: these answer that nothing can be made of grey pictures. What
# they make of real ones is tested in tests/plugins/surveying.
WITHOUT_A_SITE = {("surveying", "colmap"), ("surveying", "simulated_photographs")}
MACHINE = "machine.sock"

PLUGINS = [
    pytest.param(capability, one.name, marks=[] if capability in FAST else [pytest.mark.slow])
    for capability in (*registry.capabilities(), registry.SMOOTHERS)
    for one in registry.installed(capability)
    if one.distribution == "executive"
]


def given(capability: str, name: str, folder: Path) -> tuple[str, ...]:
    """Return the settings that have no default, and those that make it cheap."""
    if (capability, name) == ("surveying", "point_cloud_file"):
        write_parts(folder / "site.ply", [site()])
        return (f"surveying.path={folder / 'site.ply'}",)
    if (capability, name) == ("surveying", "colmap"):
        for k in range(6):
            grey = np.full((48, 64, 3), 128, np.uint8)
            Image.fromarray(grey).save(folder / f"{k}.png")
        lines = [f"{k}.png,{k},0,10" for k in range(6)]
        (folder / "positions.csv").write_text("\n".join(["name,x,y,z", *lines, ""]))
        return (f"surveying.photographs={folder}",)
    if (capability, name) == ("robot", "wire"):  # long limits, for a busy computer
        limits = ("robot.answer_limit=5 s", "robot.silence_limit=5 s")
        return (f"robot.address=unix:{folder / MACHINE}", *limits)
    return THINNED.get((capability, name), ())


@contextmanager
def machine_behind_the_wire(folder: Path) -> Iterator[None]:
    """Serve a simulated machine that lives by its own clock."""
    robot = KinematicRobot(KinematicSettings(), load_machine("m545"))
    server = MachineServer(robot, "m545", Address(str(folder / MACHINE)), silence_s=10.0)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    try:
        yield
    finally:
        server.is_ended = True
        thread.join(5)


@pytest.mark.parametrize(("capability", "name"), PLUGINS)
def test_a_shipped_plugin_keeps_its_contract(capability: str, name: str, tmp_path: Path) -> None:
    must_succeed = (capability, name) not in WITHOUT_A_SITE
    options = given(capability, name, tmp_path)
    is_remote = (capability, name) == ("robot", "wire")
    with machine_behind_the_wire(tmp_path) if is_remote else nullcontext():
        findings = hold_to_contract(Trial(capability, name, options, must_succeed=must_succeed))
    failed = [one.line() for one in findings if one.outcome is Outcome.FAIL]
    assert not failed, "\n".join(failed)
    assert len(findings) > 20


@pytest.mark.slow
def test_motion_planners_keep_it_on_another_machine() -> None:
    for one in registry.installed("motion"):
        findings = hold_to_contract(Trial("motion", one.name, model="mini", must_succeed=True))
        failed = [found.line() for found in findings if found.outcome is Outcome.FAIL]
        assert not failed, "\n".join(failed)


@pytest.mark.parametrize("capability", [*registry.capabilities(), registry.SMOOTHERS])
def test_every_shipped_capability_has_an_exercise_for_all_its_verbs(capability: str) -> None:
    exercises = {one.name for one in registry.installed(registry.EXERCISES)}
    assert capability in exercises
    source = inspect.getsource(inspect.getmodule(registry.load(registry.EXERCISES, capability)))
    verbs = getattr(registry.interface(capability), "__abstractmethods__", ())
    called = [verb for verb in verbs if f".{verb}(" in source or ".add(" in source]
    assert sorted(called) == sorted(verbs)


@pytest.mark.parametrize("name", [one.name for one in registry.installed(registry.BEHAVIOURS)])
def test_a_shipped_leaf_keeps_its_contract(name: str) -> None:
    findings = hold_to_contract(Trial("leaf", name))
    failed = [one.line() for one in findings if one.outcome is Outcome.FAIL]
    assert not failed, "\n".join(failed)
    assert len(findings) >= 8
