"""The shipped machines: their gripper, kinematics, generated models and self-filter."""

import mujoco
import numpy as np
import pytest

from executive.errors import ConfigError, DataError, ShapeError
from executive.machine.kinematics import Kinematics
from executive.machine.machine import load_machine
from executive.machine.mjcf import machine_spec
from executive.machine.self_filter import SelfFilter
from executive.machine.shape import Shape
from executive.machine.urdf import urdf

MODELS = ("m545",)


@pytest.fixture(params=MODELS)
def machine(request):
    """Each shipped machine."""
    return load_machine(request.param)


def test_gripper(recorded, machine) -> None:
    gripper, told = machine.gripper, []
    for jaw_rad in (0.0, 0.4, gripper.open_rad):
        told += [gripper.opening_m(jaw_rad), gripper.tips(jaw_rad), gripper.hulls(jaw_rad)]
        told.append(gripper.jaw_rad(max(gripper.opening_m(jaw_rad), 0.0)))
    for opening_m in (-0.01, gripper.max_opening_m + 1e-6):
        with pytest.raises(DataError) as refused:
            gripper.jaw_rad(opening_m)
        told.append(refused.value)
    told += [
        gripper.jaw_width_m,
        gripper.tip_radius_m,
        gripper.jaw_rad(gripper.max_opening_m + 5e-10),
    ]
    recorded((told, {name: link.inertia_diagonal for name, link in machine.links.items()}))


def test_figures(recorded, machine) -> None:
    arrays = "lower", "upper", "max_velocity", "max_acceleration", "max_jerk"
    loaded = "loaded_max_velocity", "loaded_max_acceleration"
    told = {name: getattr(machine, name) for name in (*arrays, *loaded)}
    told |= {"pairs": machine.collision_pairs, "parents": machine.fixed_parents}
    told |= {
        "names": machine.joint_names,
        "links": list(machine.links),
        "cabin": machine.cabin_link,
    }
    told |= {kind: [s.name for s in machine.sensors_of(kind)] for kind in ("imu", "lidar", "gnss")}
    with pytest.raises(ConfigError) as refused:
        machine.posture("cary")
    recorded((told, refused.value, machine.posture("carry")))


def test_kinematics(recorded, machine) -> None:
    kinematics, told = Kinematics(machine), []
    for name in sorted(machine.postures):
        q = machine.posture(name)
        told += [kinematics.frames(q, 0.3), kinematics.gripper(q), kinematics.jacobian(q)]
    with pytest.raises(ShapeError) as refused:
        kinematics.gripper(q[1:])
    recorded((told, refused.value))


def test_urdf(recorded, machine) -> None:
    recorded("\n".join(urdf(machine).splitlines()))


def test_mujoco_model(recorded, machine) -> None:
    model = machine_spec(machine).compile()
    data = mujoco.MjData(model)
    for name, value in zip(machine.arm_names, machine.posture("carry"), strict=True):
        data.joint(name).qpos = value
    data.joint(machine.jaw.name).qpos = 0.3
    data.ctrl[:] = 1e7
    mujoco.mj_step(model, data, 3)
    fields = (
        "body_mass", "body_inertia", "body_ipos", "body_pos", "body_quat", "body_gravcomp",
        "geom_size", "geom_pos", "geom_type", "jnt_range", "jnt_limited", "jnt_axis", "jnt_type",
        "jnt_actgravcomp", "actuator_forcerange", "actuator_gear", "actuator_trnid", "eq_data",
        "eq_obj1id", "eq_obj2id", "exclude_signature", "mesh_vert",
    )  # fmt: skip
    told = {name: getattr(model, name) for name in fields}
    # Meshes are of single precision.
    recorded((told, data.qpos, data.actuator_force), relative=1e-5)


@pytest.mark.parametrize("padding_m", [0.0, 0.15])
@pytest.mark.parametrize("shadow_m", [0.0, 0.05])
def test_self_filter(recorded, machine, padding_m, shadow_m) -> None:
    own, kinematics = SelfFilter(machine, padding_m, shadow_m), Kinematics(machine)
    frames = [kinematics.frames(machine.posture(name), 0.2) for name in ("scan", "carry")]
    rng, told = np.random.default_rng(1), []
    for sensor in machine.sensors_of("lidar"):
        points = rng.uniform(-4, 8, (1500, 3)) * (1, 0.5, 0.5)
        slices = rng.integers(0, 2, 1500)
        for held_m in (0.0, 1.0):
            found = own.inside(points, slices, sensor.name, frames, held_m)
            told += [int(found.sum()), np.flatnonzero(found)]
    recorded(told)


def test_shapes(recorded) -> None:
    corners = ((0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1.0))
    turned = {"xyz_m": (1.0, 2.0, 3.0), "rpy_rad": (0.1, 0.2, 0.3)}
    told = [
        Shape(kind="box", size=(1, 2, 3), **turned),
        Shape(kind="cylinder", size=(0.5, 2.0), **turned),
        Shape(kind="hull", points_m=corners, **turned),
    ]
    refusals = []
    for wrong in (
        {"kind": "box", "size": (1, 2)},
        {"kind": "box", "size": (1, 2, 0)},
        {"kind": "cylinder", "size": (1, 2, 3)},
        {"kind": "hull", "points_m": corners[:3]},
        {"kind": "box", "size": (1, 2, 3), "points_m": corners},
    ):
        with pytest.raises(ValueError, match="Shape") as refused:
            Shape(**wrong)
        refusals.append(str(refused.value).splitlines()[1])
    recorded(([one.vertices for one in told], refusals))
