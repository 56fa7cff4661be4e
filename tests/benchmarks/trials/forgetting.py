"""What `forgetting.py` measures."""

import importlib.util
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
from bounds import Bound, Figure, held
from perception.piles import TESTS

from executive.arrays import Float

PAIRS, AFTER, NEVER = 10, 3, 10**6
LEAST_M = 0.25  # above the ground


@cache
def drawn() -> ModuleType:
    """Return the module that draws the world for the tests of carving."""
    path = TESTS / "plugins" / "mapping" / "test_carving.py"
    spec = importlib.util.spec_from_file_location("drawn_blocks", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def blocks(rng: np.random.Generator) -> dict[str, Float]:
    """Return corners of a block that goes, one that stays, and one hidden by it [m]."""
    found = {}
    for name, away_m, side_rad, low, high in (
        ("goes", rng.uniform(4.5, 7), rng.uniform(0.15, 0.35), 0.5, 1.0),
        ("stays", 3.4, 0.75, 0.9, 1.3),
        ("hidden", 5.8, 0.75, 0.4, 0.6),
    ):
        size = rng.uniform(low, high, 3)
        middle = away_m * np.array([np.cos(side_rad), np.sin(side_rad), 0.0])
        corners = np.array([middle - size / 2, middle + size / 2])
        corners[:, 2] = 0.0, size[2]
        found[name] = corners
    return found


def seen(seed: int, after: int) -> tuple[object, dict[str, Float]]:
    """Return a map that saw all blocks: the one that stays only after the one behind it."""
    module, rng = drawn(), np.random.default_rng(seed)
    world, there = module.World(after), blocks(rng)
    world.rng, world.swing_rad = rng, rng.uniform(0, 1.5)
    world.run([there["goes"], there["hidden"]], 25)
    world.run(list(there.values()), 25)
    return world, there


def measured(seeds: Iterable[int]) -> list[Figure]:
    """Return what remains of each block, in that of a map that never forgets."""
    kept = {name: np.zeros(2) for name in ("goes", "stays", "hidden")}
    for seed in seeds:
        for column, after in enumerate((AFTER, NEVER)):
            world, there = seen(seed, after)
            world.run([there["stays"], there["hidden"]], PAIRS)  # type: ignore[attr-defined]
            for name, counts in kept.items():
                counts[column] += world.count(there[name], LEAST_M)  # type: ignore[attr-defined]
    shares = {name: 100 * left / before for name, (left, before) in kept.items()}
    words = {name: f"{shares[name]:.2f} ({a:.0f} of {b:.0f})" for name, (a, b) in kept.items()}
    return [
        held(f"voxels of a block that left, after {PAIRS} pairs [%]", shares["goes"], Bound(5, 0),
             words["goes"]),
        held("voxels kept of one that stays [%]", shares["stays"], Bound(100, is_least=True),
             words["stays"]),
        held("voxels kept of one hidden behind it [%]", shares["hidden"],
             Bound(100, is_least=True), words["hidden"]),
    ]  # fmt: skip


def pictured(path: Path, seed: int) -> Path:
    """Draw the map from the side before the block goes, and after, with and without forgetting."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    picture, axes = plt.subplots(1, 3, figsize=(13, 3.6), layout="constrained", sharey=True)
    states = (
        ("before", AFTER, 0),
        (f"{PAIRS} pairs after it left, forget_after: 0", NEVER, PAIRS),
        (f"{PAIRS} pairs after it left, forget_after: {AFTER}", AFTER, PAIRS),
    )
    for axis, (title, after, pairs) in zip(axes, states, strict=True):
        world, there = seen(seed, after)
        world.run([there["stays"], there["hidden"]], pairs)  # type: ignore[attr-defined]
        points = world.grid.points()[0]  # type: ignore[attr-defined]
        up = np.array([[-0.25, 0.97, 0.0], [0.34, 0.09, 0.94]])  # from behind the machine, 20° down
        axis.plot(*(points @ up.T).T, ",", color="#b5b5b5", rasterized=True)
        for name, color in (("stays", "#1f77b4"), ("hidden", "#2ca02c"), ("goes", "#d62728")):
            inside = (points > there[name][0] - 0.06) & (points < there[name][1] + 0.06)
            own = points[inside.all(axis=1) & (points[:, 2] > 0.06)]
            axis.plot(*(own @ up.T).T, ".", ms=1.5, color=color, label=name)
        axis.set(title=title, xlabel="across [m]", aspect="equal", xlim=(-4, 3.5), ylim=(0.5, 4))
    axes[0].legend(loc="upper left", markerscale=6)
    picture.savefig(path, dpi=75)
    return path
