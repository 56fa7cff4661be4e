"""A grasp plan as plain values, SI units in the names, for JSON and YAML."""

import json
from pathlib import Path
from typing import Any

import yaml

from executive.arrays import Float
from executive.messages.grasp import Grasp, GraspPlan


def plan_answer(plan: GraspPlan, segment: int, T_map_base: Float) -> dict[str, Any]:
    """Return what was planned, for which segment and machine;
    all poses in the frame of the cloud.
    """
    return {
        "segment": segment,
        "T_map_base": T_map_base.tolist(),
        "grasps": [_grasp(grasp) for grasp in plan.grasps],
        "refused": dict(plan.refused),
    }


def write_answer(path: Path, answered: dict[str, Any]) -> None:
    """Write JSON, or YAML if the file is named so."""
    text = (
        json.dumps(answered, indent=2) + "\n"
        if path.suffix == ".json"
        else yaml.safe_dump(answered, sort_keys=False)
    )
    path.write_text(text, encoding="utf-8")


def lines(plan: GraspPlan) -> list[str]:
    """Return what a person reads: the grasps, best first, and how many hypotheses were refused for
    which reason.
    """
    found = []
    for number, grasp in enumerate(plan.grasps, 1):
        place = " ".join(f"{x:.2f}" for x in grasp.T_map_gripper[:3, 3])
        costs = ", ".join(f"{name} {cost:.2f}" for name, cost in grasp.costs.items())
        found.append(f"  {number}  score {grasp.score:.2f}, palm at {place} m; {costs}")
    refused = ", ".join(
        f"{n} {reason}" for reason, n in sorted(plan.refused.items(), key=lambda one: -one[1])
    )
    return [*found, f"  refused    {refused or 'nothing'}"]


def _grasp(grasp: Grasp) -> dict[str, Any]:
    return {
        "T_map_gripper": grasp.T_map_gripper.tolist(),
        "approach": grasp.T_map_gripper[:3, 0].tolist(),
        "opening_m": float(grasp.opening_m),
        "score": float(grasp.score),
        "costs": {name: float(cost) for name, cost in grasp.costs.items()},
    }
