"""Settings that do not go with a machine, or with what is on the disk, are refused by name."""

from pathlib import Path

import pytest
from executive_plugins.estimation.cabin.sensors import antennas_in_imu, cabin_imu
from executive_plugins.estimation.cabin.settings import CabinSettings
from executive_plugins.mapping.scan_front_end import ScanFrontEnd
from executive_plugins.mapping.settings import MapSettings
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.surveying.settings import ColmapSettings, SimulatedPhotographsSettings

from executive.errors import ConfigError
from executive.machine.machine import Machine, load_machine

M545 = load_machine("m545")
NO_LIDAR = "has no lidar to map with: add one to its robot.yaml"


def without(*kinds: str) -> Machine:
    """Return a machine that has no sensors of some kinds."""
    kept = {name: one for name, one in M545.sensors.items() if one.kind not in kinds}
    return M545.model_copy(update={"sensors": kept})


def places(settings, machine: Machine = M545) -> list[tuple[object, ...]]:
    return [refusal.setting for refusal in settings.refusals(machine)]


def test_a_map_needs_a_lidar() -> None:
    assert places(MapSettings()) == []
    (refusal,) = MapSettings().refusals(without("lidar"))
    assert NO_LIDAR in refusal.message
    with pytest.raises(ConfigError, match=NO_LIDAR):
        ScanFrontEnd(without("lidar"), MapSettings())


def test_an_estimate_needs_an_imu_and_an_antenna_on_the_cabin() -> None:
    assert places(CabinSettings()) == []
    assert places(CabinSettings(), without("gnss")) == [()]
    assert places(CabinSettings(imu="imu_nowhere")) == [("imu",)]
    assert places(CabinSettings(), without("gnss", "imu")) == [("imu",), ()]
    with pytest.raises(ConfigError, match="no gnss antenna on the cabin"):
        antennas_in_imu(without("gnss"), cabin_imu(M545, CabinSettings().imu))
    with pytest.raises(ConfigError, match="is no imu on the cabin"):
        cabin_imu(M545, "imu_nowhere")


def test_a_base_on_wheels_needs_a_machine_that_drives() -> None:
    fixed = M545.model_copy(update={"driving": None})
    assert places(MujocoSettings(base="on_wheels")) == []
    assert places(MujocoSettings(base="on_wheels"), fixed) == [("base",)]
    assert places(MujocoSettings(), fixed) == []


def test_a_base_that_may_tip_needs_points_of_support() -> None:
    bare = M545.model_copy(update={"stance": M545.stance.model_copy(update={"supports_m": ()})})
    for scenario, base, expected in (
        ("nominal", "by_scenario", [("base",)]),
        ("kind", "by_scenario", []),
        ("nominal", "welded", []),
        ("kind", "on_legs", [("base",)]),
    ):
        assert places(MujocoSettings(scenario=scenario, base=base), bare) == expected


def test_a_folder_of_stones_is_there(tmp_path: Path) -> None:
    for folder, expected in (
        (tmp_path, []),
        (tmp_path / "none", [("site", "stones", "folder")]),
    ):
        settings = MujocoSettings.model_validate({"site": {"stones": {"folder": str(folder)}}})
        assert places(settings) == expected


def test_photographs_and_their_positions_are_there(tmp_path: Path) -> None:
    table = tmp_path / "positions.csv"
    table.write_text("name,x,y,z\n")
    none = tmp_path / "none"
    for photographs, positions, expected in (
        (tmp_path, None, []),
        (tmp_path, table, []),
        (none, None, [("photographs",)]),
        (tmp_path, none, [("positions",)]),
        (table, tmp_path, [("photographs",), ("positions",)]),
    ):
        settings = ColmapSettings(photographs=photographs, positions=positions)
        assert places(settings) == expected


def test_a_folder_for_pictures_is_new_or_empty(tmp_path: Path) -> None:
    full, empty, file = tmp_path / "full", tmp_path / "empty", tmp_path / "full" / "a.png"
    full.mkdir()
    empty.mkdir()
    file.write_bytes(b"")
    for folder, expected in (
        (None, []),
        (tmp_path / "none", []),
        (empty, []),
        (full, [("folder",)]),
        (file, [("folder",)]),
    ):
        assert places(SimulatedPhotographsSettings(folder=folder)) == expected
