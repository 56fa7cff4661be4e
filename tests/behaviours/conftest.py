"""A context without a mission: scripted plugins, a clock that steps, everything recorded."""

import inspect
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.mapping.density import dense_share
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.clock import SimulatedClock
from executive.events.site import SlotsFound
from executive.interfaces.mapping import Mapper
from executive.journal import Journal
from executive.leaf.action import Action
from executive.leaf.context import Context
from executive.leaf.job import Job
from executive.leaf.runtime import Runtime
from executive.leaf.store import Store
from executive.machine.kinematics import Kinematics
from executive.machine.machine import load_machine
from executive.messages.base_state import BaseState
from executive.messages.cloud import Cloud
from executive.messages.joints import JointSample
from executive.messages.moving_places import MovingPlaces
from executive.messages.segment import Segment
from executive.tree.build import build_tree, halt
from executive.tree.key_source import Ref
from executive.tree.language import MissionFile, Tree
from executive.tree.leaf_use import LeafUse
from executive.tree.loop_settings import LoopSettings
from executive.tree.node_kinds import CheckLeaf, Modifiers, Node, RunLeaf
from executive.tree.problem import Mark

TICK_S = 0.05


class ReadyJob(Job):
    def __init__(self, value):
        self._value = value

    def is_ready(self):
        return True

    def result(self):
        if isinstance(self._value, Exception):
            raise self._value
        return self._value

    def cancel(self):
        pass


class FakeContext(Context):
    """Plugins are plain objects; joints follow a function of time that a test may set."""

    def __init__(self, **plugins):
        self.plugins = plugins
        self.time_s = 0.0
        self.events = []
        self.shown = {}
        self.journal = Journal()
        self.run_folder = Path()
        self.holds = []
        self.below = []  # what monitors were told is below a held stone
        self.troubles = []
        self.weighed, self.carried, self.trial = None, False, None
        self.payload = None
        self.on_ground = None
        self.given_up = frozenset()
        self.regions = {}
        self._machine = load_machine("m545")
        self.positions = lambda time_s: [
            self._machine.postures["scan"][n] for n in self._machine.arm_names
        ]
        self.velocities = lambda time_s: np.zeros(len(self._machine.arm_names))
        self.jaw = lambda time_s: 0.9
        self.pushed = lambda time_s: np.zeros(3)  # by the ground at the tool [N]

    def now_s(self):
        return self.time_s

    def use(self, interface):
        return self.plugins[interface.capability]

    def start(self, verb, *args, **kwargs):
        return ReadyJob(verb(*args, **kwargs))

    def rng(self):
        return np.random.default_rng(0)

    def state(self):
        eye = np.eye(4)
        return BaseState(self.time_s, eye, eye, eye, np.zeros(3), np.zeros(3), np.eye(6), "GLOBAL")

    def joints(self):
        position = np.array([*self.positions(self.time_s), self.jaw(self.time_s)])
        velocity = np.array([*self.velocities(self.time_s), 0.0])
        effort = np.append(-self._levers.T @ self.pushed(self.time_s), 0.0)
        return JointSample(self.time_s, self._machine.joint_names, position, velocity, effort)

    @cached_property
    def _levers(self):
        """Speeds of the grasp centre by those of the joints in the first posture, shape (3, n)."""
        kinematics, q = Kinematics(self._machine), np.array(self.positions(0.0))
        J, T = kinematics.jacobian(q), kinematics.gripper(q)
        return J[:3] + np.cross(J[3:].T, T[:3, :3] @ self._machine.gripper.grasp_centre).T

    def arm(self):
        return np.array(self.positions(self.time_s))

    def gripper(self):
        T = np.eye(4)
        T[:3, 3] = [5.0, 0.0, 2.0]
        return T

    def machine(self):
        return self._machine

    def region(self, name):
        return self.regions[name]

    def slot_places(self):
        found = (event for event in self.events if isinstance(event, SlotsFound))
        return {one.slot: one.position_map for event in found for one in event.slots}

    def begin_hold(self):
        self.holds.append("begin")

    def begin_carry(self, weight=None):
        self.holds.append("carry")
        self.trial = weight

    def trial_weight(self):
        return self.trial

    def carry_over(self, below):
        self.below.append(below)

    def end_hold(self):
        self.holds.append("end")

    def verdicts(self):
        return tuple(self.troubles)

    def is_carried(self):
        return self.carried

    def weight(self):
        return self.weighed

    def payload_kg(self):
        return self.payload

    def standing(self):
        return self.on_ground

    def is_given_up(self, stone):
        return stone in self.given_up

    def last_failure(self):
        return "no way there"

    def record(self, event):
        self.events.append(event)
        self.journal.append(0, self.time_s, "main", event)

    def follow_journal(self):
        journal, told = self.journal, self.journal.length

        def news():
            nonlocal told
            found, told = journal.since(told), journal.length
            return found

        return news

    def folder(self):
        return self.run_folder

    @property
    def notes(self):
        """Return kind and payload of the recorded events."""
        return [(event.kind, event.payload()) for event in self.events]

    def show(self, entity, value):
        self.shown[entity] = value


def finish(leaf, limit_s=60.0, **inputs):
    """Drive an action to its end on a stepping clock."""
    steps, answer = leaf.run(**inputs), None
    try:
        while leaf.context.time_s < limit_s:
            waiting = steps.send(answer)
            answer = waiting.result() if waiting is not None else None
            leaf.context.time_s += TICK_S
    except StopIteration as end:
        return end.value
    raise AssertionError(f"not over after {limit_s} s")


@pytest.fixture
def fakes():
    return SimpleNamespace(Context=FakeContext, finish=finish, TICK_S=TICK_S)


class Scripted:
    """A plugin that answers each verb as a test says, and keeps what it was asked.

    An answer is a value, a list of values for one call after the other, an exception, or a function
    of the verb's arguments. Only verbs of the interface are known, with its arguments.
    """

    def __init__(self, interface, **answers):
        for verb in answers:
            getattr(interface, verb)  # a verb that the interface lacks is a mistake of the test
        self._interface, self._answers = interface, answers
        self.asked = []  # (verb, arguments by name) in order

    def __getattr__(self, verb):
        signature = inspect.signature(getattr(self._interface, verb))

        def answer(*args, **kwargs):
            bound = dict(signature.bind(self, *args, **kwargs).arguments)
            del bound["self"]
            self.asked.append((verb, bound))
            given = self._answers.get(verb)
            given = given.pop(0) if isinstance(given, list) else given
            if isinstance(given, Exception):
                raise given
            return given(**bound) if callable(given) else given

        return answer

    def answers(self, **answers):
        """Answer some verbs otherwise from now on."""
        self._answers.update(answers)

    def calls(self, verb):
        """Return the arguments of each call of a verb."""
        return [arguments for one, arguments in self.asked if one == verb]


class PointMap(Mapper):
    """A map of given points."""

    def __init__(self, points):
        self.points = np.asarray(points, dtype=float).reshape(-1, 3)
        self.masks = []
        self.seen = np.empty((0, 3))  # of what the jaws hold
        self.restless = np.empty((0, 3), dtype=np.int64)  # cubes of 1 m in which something moves

    def held(self):
        return Cloud("gripper", self.seen)

    def moving(self):
        return MovingPlaces(1.0, self.restless)

    def add_scan_pair(self, scans, motion):
        raise NotImplementedError("no leaf adds scans")

    def mask_held(self, radius_m):
        self.masks.append(radius_m)

    def remove_sphere(self, centre_map, radius_m):
        inside = np.linalg.norm(self.points - centre_map, axis=1) <= radius_m
        self.points = self.points[~inside]
        return int(inside.sum())

    def add_surface(self, points_map):
        self.points = np.vstack([self.points, points_map])

    def dense_share(self, sector, points_per_m2):
        return dense_share(self.points, sector, points_per_m2)

    def cloud(self):
        return Cloud("map", self.points)


@dataclass
class Ended:
    """How a leaf ended: its node's status and reason, what it wrote, recorded and showed."""

    status: str
    reason: str
    is_final: bool
    outputs: dict
    events: list
    shown: dict


class Stage(Runtime):
    """A tree of one leaf, ticked to its end; the leaf's context is a FakeContext."""

    def __init__(self, **plugins):
        self.clock = SimulatedClock()
        self.store = Store()
        self.leaf_context = FakeContext(**plugins)

    def context(self, node, uses):
        return self.leaf_context

    def record(self, node, event):
        """Leave out what the node itself records."""

    def ask(self, node, question, default, choices=()):
        raise NotImplementedError("no leaf asks")

    def fail(self, error, node, leaf):
        raise error

    def tick(self, leaf, *, settings=None, limit_s=60.0, **inputs):
        """Tick a leaf to its end with values on its input ports."""
        for port, value in inputs.items():
            self.store.set(port, value)
        mark = Mark("test")
        ports = {port: Ref(port, mark) for port in (*leaf.inputs, *leaf.outputs)}
        use = LeafUse(leaf.__name__, leaf, leaf.Settings(**(settings or {})), ports, ports, mark)
        node = Node(RunLeaf(use) if issubclass(leaf, Action) else CheckLeaf(use), Modifiers(), mark)
        tree = Tree("main", node, {}, {}, mark)
        root = build_tree(MissionFile("t", "", LoopSettings(), {}, {"main": tree}), self)
        began, until_s = len(self.leaf_context.events), self.leaf_context.time_s + limit_s
        root.tick_once()
        while root.status.name == "RUNNING" and self.leaf_context.time_s < until_s:
            self.leaf_context.time_s += TICK_S
            root.tick_once()
        if root.status.name == "RUNNING":
            halt(root)
        return Ended(
            root.status.name,
            root.feedback_message,
            root.is_final,
            {port: self.store.get(port) for port in leaf.outputs if port in self.store},
            self.leaf_context.events[began:],
            self.leaf_context.shown,
        )


def block(centre, size=(1.0, 0.8, 0.6), count=400, seed=0):
    """Return points on the faces of a box [m], shape (N, 3)."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.5, 0.5, (count, 3))
    axis = rng.integers(0, 3, count)
    points[np.arange(count), axis] = rng.choice([-0.5, 0.5], count)
    return points * size + centre


def segment(number, points):
    return Segment(number, points, points.mean(axis=0), np.ptp(points, axis=0))


@pytest.fixture
def stage():
    return SimpleNamespace(Stage=Stage, Scripted=Scripted, PointMap=PointMap, block=block)


@pytest.fixture
def database():
    """Return a database of two stones on the ground: 1 at (5, 0) of more points, 2 at (5, 3)."""
    objects = SqliteObjects(SqliteObjectsSettings())
    objects.open(":memory:")
    places = [block((5.0, 0.0, 0.3), count=400), block((5.0, 3.0, 0.3), count=300, seed=1)]
    objects.observe([segment(i, points) for i, points in enumerate(places)], 1.0, False)
    yield objects
    objects.close()
