"""How a mission is: what `executive ctl RUN status` replies."""

import os
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.events.event import plain
from executive.mission.mission import Mission
from executive.tree.leaf_nodes import RunNode
from executive.tree.small_nodes import WaitNode


def running_leaves(root: Behaviour) -> list[RunNode]:
    """Return the actions that are under way."""
    nodes = root.iterate()
    return [one for one in nodes if isinstance(one, RunNode) and one.status is Status.RUNNING]


def failed_leaves(root: Behaviour) -> list[RunNode]:
    """Return the actions that have failed and wait for a person's decision."""
    return [leaf for leaf in running_leaves(root) if leaf.failure is not None]


def _is_under_way(node: Behaviour) -> bool:
    """Return whether a node acts or waits, and has not failed."""
    lasts = isinstance(node, RunNode | WaitNode) and node.status is Status.RUNNING
    return lasts and getattr(node, "failure", None) is None


def standing(mission: Mission) -> dict[str, Any]:
    """Return how a mission is, as JSON holds it; times in seconds."""
    running = [one for one in mission.root.iterate() if _is_under_way(one)]
    found = {
        "phase": mission.phase,
        "reason": mission.phase_reason,
        "pid": os.getpid(),
        "tick": mission.tick,
        "mission_s": round(mission.clock.now_s(), 6),
        "machine_s": round(mission.clock.machine_s(), 6),
        "running": [{"node": one.path, "says": one.feedback_message} for one in running],
        "failed": [
            {"node": one.path, "reason": one.failure} for one in failed_leaves(mission.root)
        ],
        "questions": [
            {"node": put.node, "text": put.text, "answers": put.choices or ("yes", "no")}
            for put in mission.questions
        ],
        "latched": mission.services.plugins["robot"].latched(),
        "pauses_on_failure": mission.wishes.pause_on_failure,
    }
    return {name: plain(value) for name, value in found.items()}
