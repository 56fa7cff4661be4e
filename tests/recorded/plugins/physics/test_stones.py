"""Generated stones, hulls, directions, and a body that comes to rest."""

import mujoco
import numpy as np
from executive_plugins.physics.contact import apply_contact
from executive_plugins.physics.even_directions import even_directions
from executive_plugins.physics.quarried_block import block, ratios
from executive_plugins.physics.rounded_stone import rounded_stone
from executive_plugins.physics.settling import come_to_rest
from executive_plugins.physics.surface import Surface, uniform

from executive.geometry.hull_mesh import hull_mesh


def test_blocks(recorded) -> None:
    recorded([block(0.5 + 0.1 * seed, np.random.default_rng(seed)) for seed in range(6)])


def test_rounded_stones(recorded) -> None:
    recorded([rounded_stone(0.5, np.random.default_rng(seed)) for seed in range(4)])


def test_ratios(recorded) -> None:
    rng = np.random.default_rng(1)
    recorded(np.array([ratios(rng) for _ in range(200)]))


def test_directions(recorded) -> None:
    recorded([even_directions(count) for count in (1, 2, 30)])


def test_hulls(recorded) -> None:
    points = np.random.default_rng(2).integers(-4, 5, (30, 3)) / 4.0
    corners, triangles = hull_mesh(points)
    a, b, c = (corners[triangles[:, i]] for i in range(3))
    outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - corners.mean(axis=0))
    recorded((corners, (outward > 0).all(), float(outward.sum())))


WORLD = """<mujoco><worldbody><geom type="plane" size="5 5 1"/>
<body pos="0 0 0.4"><freejoint/><geom type="box" size="0.2 0.3 0.1" euler="20 10 0"/></body>
<body pos="2 0 1"><joint name="a" type="slide" axis="0 0 1"/><geom size="0.1"/></body>
<body pos="3 0 1"><joint name="b" type="slide" axis="0 0 1"/><geom size="0.1"/></body>
</worldbody><equality><joint joint1="a" joint2="b"/></equality></mujoco>"""


def test_a_world_comes_to_rest(recorded) -> None:
    told = []
    for contact, times in (
        (uniform(Surface(0.6, 0.08)), (0.1, 0.3)),
        (uniform(Surface(0.3, 0.01), impratio=10), (0.05, 5.0)),
    ):
        spec = mujoco.MjSpec.from_string(WORLD)
        apply_contact(spec, contact)
        model = spec.compile()
        data = mujoco.MjData(model)
        rests = come_to_rest(model, data, *times)
        told.append((rests, data.time, data.qpos, model.geom_friction, model.geom_condim))
        told.append((model.geom_solref, model.geom_solimp, model.eq_solref, model.eq_solimp))
        option = model.opt
        told.append((option.integrator, option.cone, option.impratio, option.jacobian))
    # The contact solver stops at a tolerance of its own.
    recorded(told, relative=1e-6)
