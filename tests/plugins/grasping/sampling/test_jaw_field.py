"""The gripper's tables against its polyhedra."""

import numpy as np
import pytest
from executive_plugins.grasping.sampling import jaw_field
from executive_plugins.grasping.sampling.jaw_field import NEVER, JawField, build_jaw_field

from executive.geometry.convex import depth_inside, half_spaces
from executive.machine.gripper import Gripper

CELL_M = 0.05


@pytest.fixture(scope="module")
def tables(gripper: Gripper) -> JawField:
    return build_jaw_field(gripper, CELL_M, 0.0, steps=17)


def cell_centres(tables: JawField) -> np.ndarray:
    index = np.stack(
        np.meshgrid(*(np.arange(n) for n in tables.sweep.shape[1:]), indexing="ij"), axis=-1
    )
    return np.asarray(tables.origin + CELL_M * (index + 0.5))


def test_a_cell_that_a_jaw_fills_is_swept_no_later(tables: JawField, gripper: Gripper) -> None:
    centres = cell_centres(tables).reshape(-1, 3)
    for k in (0, 8, 16):
        for side, name in enumerate(("jaw_left", "jaw_right")):
            for hull in gripper.hulls(float(tables.jaw_rad[k]))[name]:
                inside = depth_inside(half_spaces(hull), centres) > 0
                assert (tables.sweep[side].ravel()[inside] <= k).all()


def test_a_cell_far_from_a_jaw_is_not_swept_by_it(tables: JawField, gripper: Gripper) -> None:
    centres = cell_centres(tables).reshape(-1, 3)
    for side, name in enumerate(("jaw_left", "jaw_right")):
        nearest = np.full(len(centres), -np.inf)
        for angle in tables.jaw_rad:
            for hull in gripper.hulls(float(angle))[name]:
                nearest = np.maximum(nearest, depth_inside(half_spaces(hull), centres))
        assert (tables.sweep[side].ravel()[nearest < -CELL_M] == NEVER).all()


def test_the_front_is_never_behind_a_polyhedron_and_at_most_a_cell_before_it(
    tables: JawField, gripper: Gripper
) -> None:
    rng = np.random.default_rng(0)
    hulls = [hull for parts in gripper.hulls(gripper.open_rad).values() for hull in parts]
    for hull in hulls:
        points = rng.dirichlet(np.ones(len(hull)), 300) @ hull
        b, c = (np.floor((points[:, i] - tables.origin[i]) / CELL_M).astype(int) for i in (1, 2))
        assert (points[:, 0] <= tables.front[0][b, c] + 1e-5).all()
    highest = max(float(hull[:, 0].max()) for hull in hulls)
    assert tables.front[0].max() == pytest.approx(highest, abs=2 * CELL_M)


def test_fronts_only_grow_while_the_jaws_close(tables: JawField) -> None:
    assert (np.diff(tables.front, axis=0) >= 0).all()


def test_tips_dip_below_their_open_depth_on_the_way(tables: JawField, gripper: Gripper) -> None:
    assert tables.tip_a.max() > tables.tip_a[0] + 0.1
    assert tables.tip_b[0] == pytest.approx(gripper.max_opening_m / 2)
    assert tables.tip_b[-1] == pytest.approx(0.0, abs=0.01)


def test_a_skin_brings_the_front_forward_by_its_thickness(
    gripper: Gripper, tables: JawField
) -> None:
    thick = build_jaw_field(gripper, CELL_M, 0.1, steps=2)
    assert thick.front[0].max() >= tables.front[0].max() + 0.09


def test_each_polyhedron_is_made_once(gripper: Gripper, monkeypatch: pytest.MonkeyPatch) -> None:
    """The hull of each takes the most of the time, and the palm is the same at each progress."""
    made = []
    whole = jaw_field.half_spaces
    monkeypatch.setattr(jaw_field, "half_spaces", lambda one: made.append(one) or whole(one))
    steps = 5
    built = build_jaw_field(gripper, 0.1, 0.03, steps)
    parts = gripper.hulls(0.0)
    palm, moving = len(parts["palm"]), len(parts["jaw_left"]) + len(parts["jaw_right"])
    assert len(made) == palm + steps * moving
    assert (np.diff(built.front, axis=0) >= 0.0).all()  # the palm is in each
