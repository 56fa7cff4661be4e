"""What `twins.py` measures."""

from collections.abc import Iterable, Sequence

import numpy as np
from bounds import Bound, Figure, held
from perception.piles import load_scenes
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.interfaces.registration import Registrar
from executive.messages.cloud import Cloud
from executive.testing.subject import subject_of
from trials.many_stones import OTHERS, SAME, ManyStones
from trials.registration_trial import Trial, tried

RAYS = 120_000
TWINS = "identical blocks"
MEMORY_OF = "libraries and clouds included"


def layout(kind: str, rng: np.random.Generator) -> Float:
    """Return places of identical blocks at equal distances [m], shape (N, 2)."""
    pitch = rng.uniform(1.7, 2.3)
    if kind == "row":
        return np.column_stack([np.full(6, 5.0), (np.arange(6) - 2.5) * pitch])
    if kind == "square":
        places = np.indices((2, 4)).reshape(2, -1).T * pitch
        return np.asarray(places + [4.0, -1.5 * pitch])
    angles = np.arange(3) * 2.0944
    return np.column_stack([5 + 1.3 * pitch * np.cos(angles), 1.3 * pitch * np.sin(angles)])


def blocks(kind: str, seed: int) -> tuple[Cloud, Cloud, Float]:
    """Return a map, a survey, and the true T_target_source of a site of identical blocks."""
    scenes, rng = load_scenes(), np.random.default_rng(seed)
    site, _ = scenes._world(rng, 0, 0.0, 1.0, scenes._stone)
    size = rng.uniform([0.8, 0.5, 0.4], [1.2, 0.8, 0.8])
    corners = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T * size
    places = layout(kind, rng)
    for place in places:
        moved = corners + [*place, 0.5 * size[2] - 0.03]
        scenes._add(site, moved, ConvexHull(moved).simplices)
    centre = np.array([*places.mean(axis=0), 0.3])
    target = scenes._swept(site, rng, RAYS)
    survey = scenes._surveyed(site, rng, RAYS, centre)
    if kind != "triangle":  # each sees two thirds of the blocks
        shown = np.ptp(places[:, 1]) / 5
        target, survey = target[target[:, 1] < shown], survey[survey[:, 1] > -shown]
    R = exp_so3(np.array([0, 0, rng.uniform(-np.pi, np.pi)])) @ exp_so3(rng.normal(0, 0.03, 3))
    T = pose(R, rng.uniform(-15, 15, 3))
    return Cloud("map", target), Cloud("survey", transform(inverse(T), survey)), T


def measured(seeds: Iterable[int]) -> list[Trial]:
    """Register all sites of the seeds."""
    scenes, trials = load_scenes(), []
    with subject_of("registration", "segment_shot", ()).started() as plugin:
        assert isinstance(plugin, Registrar)
        for seed in seeds:
            for kind in ("row", "square", "triangle"):
                trials.append(tried(plugin, TWINS, *blocks(kind, seed)))
            same = scenes.scene_of(seed, stretch=1.0)
            other = scenes.scene_of(seed, survey_seed=seed + 500_000)
            trials.append(tried(plugin, "natural", same.target, same.source, same.T_target_source))
            trials.append(tried(plugin, "another site", other.target, other.source, None))
    return trials


def figures(drawn: Sequence[Trial], many: ManyStones) -> list[Figure]:
    """Return the figures with their bounds, of the sites of all seeds and of those of 99 stones."""
    trials = [*drawn, *many.trials]
    kinds = {kind: [t for t in trials if t.kind == kind] for kind in {t.kind for t in trials}}
    natural, twins, others = (kinds[k] for k in ("natural", TWINS, "another site"))
    wrong = [t for t in trials if t.accepted and not t.is_right]
    right = sum(t.accepted and t.is_right for t in natural)
    refused = [t.cpu_ms for t in others if not t.accepted]
    accepted = [t.cpu_ms for t in natural if t.accepted]
    return [
        held("wrong motions accepted", len(wrong), Bound(0), f"{len(wrong)} of {len(trials)}"),
        held(
            "sites of seven natural stones registered [%]",
            100 * right / len(natural),
            Bound(95, 99.5, is_least=True),
            f"{right} of {len(natural)}",
        ),
        Figure("sites of identical blocks refused", f"{sum(not t.accepted for t in twins)} of "
               f"{len(twins)}"),
        Figure("largest rival of an accepted natural site", f"{max(t.ratio for t in natural):.1e}"),
        held("accepting, seven stones, median [ms]", _median(accepted), Bound(150, 100)),
        held("refusing, seven stones, median [ms]", _median(refused), Bound(250, 150)),
        held("refusing 99 stones [ms]", kinds[OTHERS][0].cpu_ms, Bound(1000)),
        Figure("accepting 99 stones [ms]", f"{kinds[SAME][0].cpu_ms:.0f}"),
        held(f"peak memory with these, {MEMORY_OF} [MB]", many.peak_mb, Bound(500)),
    ]  # fmt: skip


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else float("nan")
