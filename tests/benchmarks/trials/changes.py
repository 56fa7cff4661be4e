"""What `changes.py` measures."""

import importlib.util
from collections import Counter
from collections.abc import Iterable, Sequence
from types import ModuleType

import numpy as np
from bounds import Bound, Figure, held
from perception.piles import TESTS

from executive.arrays import Float
from executive.commands.clouds.changes import _compared, _Found
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_rpy
from executive.messages.segment import Segment

NOISE_M, NEAR_M, APART_M, STAYED = 0.06, 0.35, 1.5, 4
Site = dict[str, tuple[Float, float]]


def drawn() -> ModuleType:
    """Return the module that draws the sites for the tests of the command."""
    path = TESTS / "commands" / "test_changes.py"
    spec = importlib.util.spec_from_file_location("drawn_sites", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def places(rng: np.random.Generator, count: int) -> list[Float]:
    """Return places on the ground that are far enough apart [m], each (2,)."""
    found: list[Float] = []
    while len(found) < count:
        place = rng.uniform(-3.2, 3.2, 2)
        if all(np.hypot(*(place - other)) > APART_M for other in found):
            found.append(place)
        elif rng.uniform() < 0.02:  # no room is left: begin anew
            found.clear()
    return found


def measured(seeds: Iterable[int]) -> list[Figure]:
    """Return how many of each kind are told rightly."""
    module, right, errors_mm, sites = drawn(), Counter[str](), list[float](), 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        names = [chr(100 + i) for i in rng.permutation(40)[:7]]
        at, turn_rad = places(rng, 9), float(rng.uniform(-3, 3))
        before: Site = {name: (at[i], 0.0) for i, name in enumerate(names[:6])}
        after: Site = {name: before[name] for name in names[2:6]}
        after |= {names[1]: (at[7], turn_rad), names[6]: (at[8], 0.0)}
        clouds = (module.site(2 * seed, before), module.site(2 * seed + 1, after))
        found = _compared(*clouds, NOISE_M, ())
        sites += 1
        right.update(went=_is_one(found.went, at[0]), came=_is_one(found.came, at[8]))
        right.update(stayed=found.stayed == STAYED and not found.unseen)
        error_m = _moved_by(found, at[1], at[7], turn_rad)
        right.update(moved=error_m < NEAR_M)
        errors_mm.append(1e3 * error_m)
    figures = [
        held(f"stones that {kind} [%]", 100 * right[kind] / sites, Bound(95, 100, is_least=True),
             f"{right[kind]} of {sites}")
        for kind in ("went", "came", "moved")
    ]  # fmt: skip
    told = f"{right['stayed']} of {sites}"
    return [
        *figures,
        held("sites whose four others stayed [%]", 100 * right["stayed"] / sites,
             Bound(95, 100, is_least=True), told),
        held("place of what moved, median [mm]", float(np.median(errors_mm)), Bound(20, 10)),
    ]  # fmt: skip


def _is_one(told: Sequence[Segment], place: Float) -> bool:
    """Return whether exactly one stone is told, at a place."""
    return len(told) == 1 and bool(np.hypot(*(told[0].centroid[:2] - place)) < NEAR_M)


def _moved_by(found: _Found, old: Float, new: Float, turn_rad: float) -> float:
    """Return how far off the motion of the one that moved is [m]; infinite if another is told."""
    if len(found.moved) != 1:
        return float("inf")
    true = pose(from_rpy(0, 0, turn_rad), np.zeros(3))
    true[:2, 3] = new - true[:2, :2] @ old
    middle = np.array([*old, 0.3])
    return float(np.linalg.norm(transform(found.moved[0][2], middle) - transform(true, middle)))
