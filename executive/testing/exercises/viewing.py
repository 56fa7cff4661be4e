"""Viewing: one value of each kind that a mission shows, and some that nobody knows."""

import tempfile
from pathlib import Path
from typing import TypedDict

import numpy as np

from executive.interfaces.viewing import Viewer
from executive.machine.machine import Machine
from executive.messages.alignment import Alignment
from executive.messages.base_state import BaseState
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp
from executive.messages.joints import JointSample
from executive.messages.placement import Slot
from executive.messages.request import MotionPlan
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import Stone, StoneState
from executive.messages.trajectory import JointTrajectory
from executive.messages.verdict import Trouble, Verdict
from executive.testing.exercise import Exercise


def messages(machine: Machine) -> list[tuple[str, object]]:
    """Return one of each kind that a mission may show, and some that nobody knows."""
    points = np.random.default_rng(1).normal(0, 1, (200, 3))
    n = len(machine.joint_names)
    segment = Segment(0, points, points.mean(axis=0), np.ones(3))
    trajectory = JointTrajectory(("a",), np.array([0.0, 1.0]), np.zeros((2, 1)), np.zeros((2, 1)))
    state = BaseState(
        0.0, np.eye(4), np.eye(4), np.eye(4), np.zeros(3), np.zeros(3), np.eye(6), "GLOBAL"
    )
    plane = np.array([0, 0, 1.0, 0])
    return [
        ("state", state),
        ("joints", JointSample(0.0, machine.joint_names, np.zeros(n), np.zeros(n), np.zeros(n))),
        ("map", Cloud("map", points)),
        ("survey", Cloud("survey", points)),
        ("nothing", Cloud("map", np.zeros((0, 3)))),
        ("segmentation", Segmentation("map", (segment,), Cloud("map", points), plane)),
        ("stones/1", Stone(1, StoneState.ON_GROUND, points, np.zeros(3), np.eye(4), False)),
        ("stones/1", Stone(1, StoneState.LOST, points, np.zeros(3), np.eye(4), False)),
        ("grasp", Grasp(np.eye(4), 1.5, 0.5, {"align_rad": 0.1})),
        ("grasp", Grasp(np.eye(4), 99.0, 0.5, {})),
        ("path", MotionPlan(trajectory, "", points[:5])),
        ("path", MotionPlan(None, "out of reach", np.zeros((0, 3)))),
        ("slots/1", Slot(1, np.zeros(3))),
        ("alignment", Alignment(np.eye(4), False, "overlap 0.2 < 0.5", 0.1, 0.2)),
        ("verdict", Verdict(1.0, "jaw_slip", Trouble.SLIP, "moved 0.1 rad")),
        ("tree", {"main": "RUNNING", "main/0:ScanSwing": "RUNNING"}),
        ("tree", {}),
        ("number", 3.0),
        ("none", None),
    ]


class ViewingInputs(TypedDict):
    """Messages of all kinds, each by the entity that shows it."""

    messages: list[tuple[str, object]]


class ViewingExercise(Exercise[Viewer, ViewingInputs]):
    """A recording of everything; a viewer answers nothing."""

    def inputs(self, machine: Machine) -> ViewingInputs:
        return {"messages": messages(machine)}

    def run(self, plugin: Viewer, inputs: ViewingInputs) -> object:
        with tempfile.TemporaryDirectory() as folder:
            plugin.open(str(Path(folder) / "recording.rrd"))
            for k, (entity, value) in enumerate(inputs["messages"]):
                plugin.show(k / 10, entity, value)
            plugin.close()
        return None
