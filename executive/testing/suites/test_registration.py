"""What every registrar must do, whatever its method."""

import numpy as np
import pytest

from executive.geometry.pose import inverse
from executive.geometry.rotation import angle_between
from executive.interfaces.registration import Registrar
from executive.messages.cloud import Cloud
from executive.testing.exercises.registration import T_TRUE, mapped, survey
from executive.testing.pytest_plugin import Insist

CAPABILITY = "registration"


@pytest.mark.parametrize("stones_seed", [1, 2])
def test_the_same_site_is_laid_over_itself(
    plugin: Registrar, stones_seed: int, insist: Insist
) -> None:
    found = plugin.register(mapped(stones_seed), survey(stones_seed), np.random.default_rng(0))
    insist(found.accepted, found.reason)
    assert angle_between(found.T_target_source[:3, :3], T_TRUE[:3, :3]) < np.radians(1.0)
    assert np.linalg.norm(found.apply(inverse(T_TRUE)[:3, 3][None])[0]) < 0.05
    assert found.timings_ms["total"] > 0


def test_another_site_is_refused(plugin: Registrar) -> None:
    found = plugin.register(mapped(1), survey(3), np.random.default_rng(0))
    assert not found.accepted
    assert found.reason


def test_an_empty_survey_is_refused_with_a_reason(plugin: Registrar) -> None:
    found = plugin.register(mapped(1), Cloud("survey", np.empty((0, 3))), np.random.default_rng(0))
    assert not found.accepted
    assert found.reason
