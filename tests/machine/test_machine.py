"""Machines as files: what is shipped is whole, what is wrong is refused with the field and the
cure.
"""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import yaml

from executive.errors import ConfigError
from executive.machine.machine import load_machine, machine_folder
from executive.machine.mjcf import machine_spec, mjcf


def changed(tmp_path: Path, **changes: Any) -> str:
    """Write the small machine with `a__b__0=value` put at a.b.0, and return its folder."""
    description = yaml.safe_load((machine_folder("mini") / "robot.yaml").read_text())
    for key, value in changes.items():
        *path, last = [int(part) if part.isdigit() else part for part in key.split("__")]
        block = description
        for part in path:
            block = block[part]
        block[last] = value
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(description))
    return str(tmp_path)


def test_a_machine_is_found_by_the_path_of_its_folder(tmp_path: Path) -> None:
    assert load_machine(changed(tmp_path, name="other")).name == "other"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"joints__1__range": [1.0, -1.0]}, ["joints.1", "range must rise"]),
        ({"joints__1__range": None}, ["joints.1", "a continuous joint has no range"]),
        ({"joints__2__axis": [0, 2, 0]}, ["joints.2", "axis must have length 1"]),
        ({"joints__2__parent": "house"}, ["STICK has parent 'house'; the chain needs 'boom'"]),
        ({"joints__0__max_velocty": 1.0}, ["joints.0.max_velocty", "Extra inputs"]),
        (
            {"joints__0__provenance": "hearsay"},
            ["joints.0.provenance", "'measured', 'paper' or 'guess'"],
        ),
        ({"joints__0__provenance": {"axis": "paper"}}, ["joints.0", "lacks `rest`"]),
        ({"joints__0__provenance": {"rest": "paper", "axes": "guess"}}, ["provenance names axes"]),
        ({"turn_joint": "SWNG"}, ["turn_joint names 'SWNG'", "Did you mean 'SWING'?"]),
        ({"bodies__boom__mass_kg": -1}, ["bodies.boom.mass_kg", "greater than 0"]),
        (
            {"bodies__boom__shapes__0__size": [1.0]},
            ["bodies.boom.shapes.0", "a box has 3 positive sizes"],
        ),
        ({"sensors__imu_base__link": "hous"}, ["sensors names 'hous'", "Did you mean 'house'?"]),
        ({"sensors__imu_base__kind": "compass"}, ["sensors.imu_base", "compass"]),
        ({"postures__carry__LIFT": 9.0}, ["posture carry is outside the range of LIFT"]),
        ({"postures__scan": {"LIFT": 0.0}}, ["posture scan must give exactly SWING, LIFT"]),
        ({"postures": {"carry": {}}}, ["postures lacks `scan`"]),
        ({"jaw__open_rad": 0.5}, ["jaw.open_rad 0.5 differs from gripper.open_rad"]),
    ],
)
def test_a_bad_description_is_refused_with_file_field_and_cure(
    tmp_path: Path, changes: dict[str, Any], words: list[str]
) -> None:
    with pytest.raises(ConfigError) as refused:
        load_machine(changed(tmp_path, **changes))
    for word in [str(tmp_path / "robot.yaml"), *words]:
        assert word in str(refused.value)


@pytest.mark.parametrize(
    ("text", "words"), [("joints: [", "not readable as YAML"), ("7", "expected a mapping")]
)
def test_a_file_that_is_no_mapping_is_refused(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "robot.yaml").write_text(text)
    with pytest.raises(ConfigError, match=words):
        load_machine(str(tmp_path))


def test_an_unknown_machine_is_answered_with_the_nearest() -> None:
    with pytest.raises(ConfigError, match="Did you mean 'm545'"):
        load_machine("m54")


@pytest.mark.parametrize("name", ["m545", "mini"])
@pytest.mark.parametrize("jaws", ["closed", "open"])
def test_postures_touch_nothing_all_the_way_round(name: str, jaws: str) -> None:
    machine = load_machine(name)
    model = machine_spec(machine).compile()
    data = mujoco.MjData(model)
    data.joint(machine.jaw.name).qpos = data.joint(machine.jaw.mirror_name).qpos = (
        machine.jaw.open_rad * (jaws == "open")
    )
    for posture in machine.postures:
        for joint, value in zip(machine.arm_names, machine.posture(posture), strict=True):
            data.joint(joint).qpos = value
        for turn_rad in np.linspace(-np.pi, np.pi, 73):
            data.joint(machine.turn_joint).qpos = turn_rad
            mujoco.mj_forward(model, data)
            assert data.ncon == 0, (posture, turn_rad)


def test_hulls_of_the_simulated_jaws_lie_where_the_description_says() -> None:
    machine = load_machine("m545")
    model = machine_spec(machine).compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    for i, shape in enumerate(machine.links["jaw_left"].shapes):
        geom, mesh = data.geom(f"jaw_left_{i}"), model.mesh(f"jaw_left_{i}")
        corners = model.mesh_vert[mesh.vertadr[0] : mesh.vertadr[0] + mesh.vertnum[0]]
        world = corners @ geom.xmat.reshape(3, 3).T + geom.xpos
        body = data.body("jaw_left")
        link = (world - body.xpos) @ body.xmat.reshape(3, 3)
        distance = np.linalg.norm(link[:, None] - shape.vertices[None], axis=2).min(axis=1)
        assert distance.max() < 1e-6  # MuJoCo keeps vertices as single floats


def test_the_written_mjcf_compiles_to_the_same_machine() -> None:
    machine = load_machine("mini")
    model = mujoco.MjModel.from_xml_string(mjcf(machine))
    assert model.nu == len(machine.joint_names)
    assert model.body_mass.sum() == pytest.approx(
        sum(link.mass_kg for link in machine.links.values())
    )
