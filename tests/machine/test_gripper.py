"""The gripper's polyhedra and the mapping between jaw angle and opening."""

import numpy as np
import pytest

from executive.errors import DataError
from executive.machine.gripper import Gripper
from executive.machine.machine import load_machine


@pytest.fixture(params=["m545", "mini"])
def gripper(request: pytest.FixtureRequest) -> Gripper:
    return load_machine(request.param).gripper


def test_the_tips_meet_when_closed(gripper: Gripper) -> None:
    assert gripper.opening_m(0.0) == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(gripper.tips(0.0)[0], gripper.tips(0.0)[1], atol=1e-9)


def test_the_m545_opens_as_published() -> None:
    gripper = load_machine("m545").gripper
    assert gripper.max_opening_m == pytest.approx(2.2, abs=0.05)
    assert gripper.tip_radius_m == pytest.approx(1.28, abs=0.005)
    assert gripper.jaw_width_m == pytest.approx(0.56)


def test_opening_and_angle_are_inverse_and_are_the_distance_of_the_tips(gripper: Gripper) -> None:
    for jaw_rad in np.linspace(0, gripper.open_rad, 12):
        left, right = gripper.tips(jaw_rad)
        assert gripper.opening_m(jaw_rad) == pytest.approx(np.linalg.norm(left - right))
        assert gripper.jaw_rad(gripper.opening_m(jaw_rad)) == pytest.approx(jaw_rad, abs=1e-9)


def test_refuses_an_opening_that_no_angle_gives(gripper: Gripper) -> None:
    with pytest.raises(DataError, match=r"ask for 0\.00 to"):
        gripper.jaw_rad(gripper.max_opening_m + 0.01)


def test_each_tip_is_a_corner_of_its_jaw_at_every_angle(gripper: Gripper) -> None:
    for jaw_rad in (0.0, 0.3, gripper.open_rad):
        hulls, tips = gripper.hulls(jaw_rad), gripper.tips(jaw_rad)
        for name, tip in zip(("jaw_left", "jaw_right"), tips, strict=True):
            corners = np.vstack(hulls[name])[:, :2]
            assert np.linalg.norm(corners - tip[:2], axis=1).min() < 1e-9


def test_the_jaws_mirror_each_other_and_do_not_cross_when_closed(gripper: Gripper) -> None:
    hulls = gripper.hulls(0.4)
    left, right = np.vstack(hulls["jaw_left"]), np.vstack(hulls["jaw_right"])
    np.testing.assert_allclose(left * (1, -1, 1), right, atol=1e-12)
    assert np.vstack(gripper.hulls(0.0)["jaw_left"])[:, 1].min() > -1e-9
