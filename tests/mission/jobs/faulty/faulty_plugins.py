"""Plugins that misbehave on purpose, one for each capability that has jobs."""

import ctypes
import itertools
import os
import signal
import sys
import time
from collections import deque
from pathlib import Path

import numpy as np

from executive.config import Settings
from executive.faults.plugin_faults import with_nan
from executive.interfaces.alignment import Aligner
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.placing import PlacementPlanner
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.interfaces.surveying import Survey
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp, GraspPlan
from executive.messages.placement import Slot
from executive.messages.request import MotionPlan
from executive.messages.segment import Segmentation

LEAKED_BYTES = 50_000_000
LATE_S = 0.2  # later than the latency of 0.1 s, and within the limit of the verb


class FaultySettings(Settings):
    """What a plugin does wrong.

    Attributes:
        fault: The fault; empty for none.
        once: A file that is written at the first fault; while it is there, the plugin is well.
    """

    fault: str = ""
    once: str = ""


def fault_raise():
    raise ValueError("a bug")  # the line of: raise


def fault_wrong_type():
    return {"not": "an answer"}


def fault_hang():
    while True:
        time.sleep(0.01)  # the line of: hang


def fault_hold_gil():
    deque(itertools.repeat(0), maxlen=0)  # the line of: hold_gil


def fault_sigkill():
    os.kill(os.getpid(), signal.SIGKILL)


def fault_sigstop():
    os.kill(os.getpid(), signal.SIGSTOP)


def fault_segfault():
    ctypes.string_at(0)  # the line of: segfault


def fault_os_exit():
    os._exit(0)


def fault_sys_exit():
    sys.exit(0)  # the line of: sys_exit


def fault_unpicklable_answer():
    return lambda: None


def fault_leak():
    kept = []
    while True:
        kept.append(np.ones(LEAKED_BYTES, dtype=np.uint8))  # the line of: leak


class Faulty:
    """Misbehaves in every verb, or when it is started."""

    is_stateless = True
    Settings = FaultySettings

    def __init__(self, settings):
        self.settings = settings

    def start(self):
        if self.settings.fault == "start":
            raise ValueError("cannot start")  # the line of: start

    def _do(self, answer):
        name, once = self.settings.fault, self.settings.once
        if not name or (once and Path(once).exists()):
            return answer
        if once:
            Path(once).touch()
        if name == "late":
            time.sleep(LATE_S)
        if name in ("late", "nan"):
            return with_nan(answer) if name == "nan" else answer
        return globals()[f"fault_{name}"]()


def cloud():
    return Cloud("map", np.zeros((3, 3)))


def plan():
    return MotionPlan(None, "stays where it is", np.zeros((1, 3)))


def alignment():
    return Alignment(np.eye(4), False, "not tried", 0.0, 0.0)


class FaultySegmenter(Faulty, Segmenter):
    latency_s = {"segment": 0.1}

    def segment(self, *_):
        return self._do(Segmentation("map", (), cloud(), np.array([0.0, 0.0, 1.0, 0.0])))

    def merge(self, *_):
        return cloud()


class FaultySurvey(Faulty, Survey):
    latency_s = {"survey": 0.1}

    def survey(self, *_):
        return self._do(cloud())


class FaultyAligner(Faulty, Aligner):
    latency_s = {"align": 0.1}

    def align(self, *_):
        return self._do(alignment())


class FaultyRegistrar(Faulty, Registrar):
    latency_s = {"register": 0.1, "find": 0.1}

    def register(self, *_):
        return self._do(alignment())

    def find(self, *_):
        return self._do(alignment())


class FaultyMotion(Faulty, MotionPlanner):
    latency_s = {"move": 0.1, "swing": 0.1}

    def reach(self, *_):
        return None

    def move(self, *_):
        return self._do(plan())

    def swing(self, *_):
        return self._do(plan())


class FaultyGrasps(Faulty, GraspPlanner):
    latency_s = {"plan": 0.1}

    def plan(self, *_):
        return self._do(GraspPlan((Grasp(np.eye(4), 1.0, 0.0, {}),), {}))


class FaultyPlaces(Faulty, PlacementPlanner):
    latency_s = {"slots": 0.1, "plan": 0.1}

    def slots(self, *_):
        return self._do((Slot(1, np.zeros(3)),))

    def plan(self, *_):
        return self._do(())


PLUGINS = {
    "segmentation": FaultySegmenter,
    "surveying": FaultySurvey,
    "alignment": FaultyAligner,
    "registration": FaultyRegistrar,
    "motion": FaultyMotion,
    "grasping": FaultyGrasps,
    "placing": FaultyPlaces,
}
