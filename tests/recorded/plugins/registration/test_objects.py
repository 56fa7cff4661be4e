"""Registration and search of one object on a thinned site: accepted, and refused by each gate."""

import numpy as np
import pytest

from executive.messages.cloud import Cloud
from executive.testing.exercises.registration import site, survey
from executive.testing.subject import subject_of

# The refinement stops at a tolerance of its own.
RELATIVE = 1e-6
THIN = Cloud("map", site(1, 5)[::4].copy())


def lump(seed: int = 1, count: int = 9000) -> np.ndarray:
    rng = np.random.default_rng(seed)
    d = rng.normal(size=(count, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    waves = np.random.default_rng(7).normal(0, 2, (3, 3))
    return d * (0.6 * (1 + 0.12 * np.sin(d @ waves).sum(axis=1)))[:, None] * [1.0, 0.7, 0.6]


def registered(name: str, *options: str):
    return subject_of("registration", name, [f"registration.{one}" for one in options]).started()


@pytest.mark.parametrize(
    "option",
    ["min_overlap=0.99", "max_rmse_m=0.001", "min_matched=6", "max_match_m=0.05", "candidates=1"],
)
def test_gates(recorded, option) -> None:
    with registered("segment_shot", option, "falls_back=false") as plugin:
        found = plugin.register(THIN, survey(1), np.random.default_rng(1))
    recorded(found, relative=RELATIVE)


def test_other_sites_are_refused(recorded) -> None:
    level = Cloud("map", np.random.default_rng(0).uniform(-3, 3, (4000, 3)) * [1, 1, 0.001])
    with registered("segment_shot", "falls_back=false") as plugin:
        told = [
            plugin.register(THIN, other, np.random.default_rng(1))
            for other in (survey(2), level, Cloud("survey", np.empty((0, 3))))
        ]
    recorded(told, relative=RELATIVE)


def test_an_object_is_found(recorded) -> None:
    rng = np.random.default_rng(2)
    ground = np.column_stack([rng.uniform(-4, 4, (9000, 2)), np.zeros(9000)])
    turned = lump(3) @ np.linalg.qr(rng.normal(size=(3, 3)))[0].T + [1.0, 2.0, 0.4]
    seen = turned[(turned[:, 2] > 0.02) & (turned[:, 0] < 1.2)]
    scene = Cloud("map", np.vstack([ground, seen]))
    with registered("segment_shot", "falls_back=false") as plugin:
        told = [
            plugin.find(scene, Cloud("model", lump())),
            plugin.find(scene, Cloud("model", lump() * 3)),
            plugin.find(scene, Cloud("model", np.ones((9, 3)))),
            plugin.find(Cloud("map", ground[:9]), Cloud("model", lump())),
        ]
    recorded(told, relative=RELATIVE)
