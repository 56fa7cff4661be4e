"""What every registrar must do, whatever its method."""

from collections.abc import Iterator

import numpy as np
import pytest

from executive import registry
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import angle_between, from_rpy
from executive.interfaces.registration import Registrar
from executive.messages.cloud import Cloud

T_TRUE = pose(from_rpy(0.03, -0.04, 2.2), np.array([14.0, -8.0, 3.0]))
PARTS = {
    "segmentation": "ground_and_clusters",
    "alignment": "gicp",
}  # what a registrar is given for other capabilities


@pytest.fixture(params=[plugin.name for plugin in registry.installed("registration")])
def registrar(request: pytest.FixtureRequest) -> Iterator[Registrar]:
    plugin = registry.load("registration", request.param)
    parts = {name: registry.load(name, chosen) for name, chosen in PARTS.items()}
    services = {name: part(part.Settings()) for name, part in parts.items()} | {
        "rng": np.random.default_rng(0)
    }
    registrar = plugin(
        plugin.Settings(), *(services[name] for name in registry.dependencies_of(plugin))
    )
    registrar.start()
    yield registrar
    registrar.close()


def site(stones_seed: int, sampling_seed: int) -> np.ndarray:
    """Five lumpy boulders on level ground: the same site, sampled differently."""
    shape, rng = np.random.default_rng(stones_seed), np.random.default_rng(sampling_seed)
    xy = rng.uniform(-5.5, 5.5, (60_000, 2))
    parts = [np.column_stack([xy, 0.04 * np.sin(xy[:, 0] + stones_seed)])]
    angles = np.arange(5) * 1.2566 + shape.uniform(-0.3, 0.3, 5)
    for angle in angles:
        distance, size = shape.uniform(1.8, 4.2), shape.uniform(0.5, 0.7)
        squeeze, turn = shape.uniform(0.6, 1.0, 3), from_rpy(*shape.uniform(-3, 3, 3))
        waves = shape.normal(0, 2, (3, 3))
        d = rng.normal(size=(9000, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        lump = d * (size * (1 + 0.12 * np.sin(d @ waves).sum(axis=1)))[:, None] * squeeze @ turn.T
        lump += [distance * np.cos(angle), distance * np.sin(angle), 0.25]
        parts.append(lump[lump[:, 2] > 0])
    points = np.vstack(parts)
    return points + rng.normal(0, 0.008, points.shape)


def survey(stones_seed: int, scale: float = 1.006) -> Cloud:
    return Cloud("survey", transform(inverse(T_TRUE), site(stones_seed, 77) * scale))


def test_it_is_a_registrar(registrar: Registrar) -> None:
    assert isinstance(registrar, Registrar)


@pytest.mark.parametrize("stones_seed", [1, 2])
def test_the_same_site_is_laid_over_itself(registrar: Registrar, stones_seed: int) -> None:
    found = registrar.register(
        Cloud("map", site(stones_seed, 5)), survey(stones_seed), np.random.default_rng(0)
    )
    assert found.accepted, found.reason
    assert angle_between(found.T_target_source[:3, :3], T_TRUE[:3, :3]) < np.radians(1.0)
    assert np.linalg.norm(found.apply(inverse(T_TRUE)[:3, 3][None])[0]) < 0.05
    assert found.timings_ms["total"] > 0


def test_another_site_is_refused(registrar: Registrar) -> None:
    found = registrar.register(Cloud("map", site(1, 5)), survey(3), np.random.default_rng(0))
    assert not found.accepted
    assert found.reason


def test_the_same_clouds_and_seed_give_the_same_bits_and_stay_as_they_were(
    registrar: Registrar,
) -> None:
    target, source = Cloud("map", site(1, 5)), survey(1)
    before = target.points.copy(), source.points.copy()
    first, second = (registrar.register(target, source, np.random.default_rng(3)) for _ in range(2))
    np.testing.assert_array_equal(first.T_target_source, second.T_target_source)
    assert first.scale == second.scale
    np.testing.assert_array_equal(target.points, before[0])
    np.testing.assert_array_equal(source.points, before[1])


def test_an_empty_survey_is_refused_with_a_reason(registrar: Registrar) -> None:
    found = registrar.register(
        Cloud("map", site(1, 5)), Cloud("survey", np.empty((0, 3))), np.random.default_rng(0)
    )
    assert not found.accepted
    assert found.reason
