"""The JSON schema: it is one, it takes what loads, and it refuses what an editor should
underline.
"""

from pathlib import Path
from typing import Any

import pytest
import yaml

from executive.tree.catalogue import Catalogue
from executive.tree.load import load_mission
from executive.tree.resolved import resolved_yaml
from executive.tree.schema import mission_schema
from executive.tree.sources import shipped_folder

jsonschema = pytest.importorskip("jsonschema")

GOOD = """
api: 1
mission: good
plugins:
  robot: {plugin: mujoco, site: {stones: {count: 3}}}
  estimation: gnss_imu
  mapping: {voxel_m: 0.2}
  monitoring: [jaw_slip, {plugin: payload_drop}]
trees:
  main:
    sequence:
      - {run: Scan, with: {angle: 90 deg}, out: {cloud: "{c}"}, retry: 3, on_failure: {wait: 1 s}}
      - {for_each: {item: s, in: "{stones}"}, do: {call: pick, in: {stone: "{s}"}}, if: {not: Calm}}
      - {loop: {until: {all: [Calm, "{done}"]}}, do: {ask: "Go on?", default: false}}
  pick: {in: {stone: Stone}, run: Pick, optional: true}
"""


@pytest.fixture
def validator(catalogue: Catalogue) -> Any:
    schema = mission_schema(catalogue)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_a_good_mission_satisfies_the_schema(validator: Any) -> None:
    validator.validate(yaml.safe_load(GOOD))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("count: 3", "count: -3"),
        ("count: 3", "cuont: 3"),
        ("run: Scan", "run: Skan"),
        ("angle: 90 deg", "angel: 90 deg"),
        ("run: Pick", "run: Calm"),
        ("optional: true", "optinal: true"),
        ('cloud: "{c}"', 'clowd: "{c}"'),
        ('cloud: "{c}"', "cloud: c"),
        ("retry: 3", "retry: 0"),
        ("item: s, ", ""),
        ("[Calm, ", "[Scan, "),
        ("mission: good", "mission: not good"),
        ("estimation: gnss_imu", "estimation: gps"),
        ("api: 1", "api: 2"),
        ("loop: {until", "loop: {while"),
    ],
)
def test_a_mistake_does_not_satisfy_the_schema(validator: Any, old: str, new: str) -> None:
    assert old in GOOD
    assert not validator.is_valid(yaml.safe_load(GOOD.replace(old, new)))


@pytest.mark.parametrize("does", ["tell", "hold", "fail", "stop"])
@pytest.mark.parametrize(
    "condition", ["estimate", "tracking", "joint_limits", "effort", "encoders"]
)
def test_a_condition_takes_each_rule_by_its_word_or_with_settings(
    validator: Any, condition: str, does: str
) -> None:
    for rule in (does, {"do": does, "after": "2 s"}):
        validator.validate({**yaml.safe_load(GOOD), "watch": {condition: rule}})
    for wrong in ("explode", {"do": "explode"}, {"do": does, "aftr": "2 s"}, None):
        assert not validator.is_valid({**yaml.safe_load(GOOD), "watch": {condition: wrong}})


def test_a_mission_written_out_satisfies_the_schema(validator: Any, load: Any) -> None:
    mission = load(
        "trees:\n  main:\n    sequence:\n      - {run: Scan, with: {angle: 1}, timeout: 3 min}\n"
    )
    validator.validate(yaml.safe_load(resolved_yaml(mission)))


@pytest.mark.parametrize(
    "path", sorted(shipped_folder().rglob("*.yaml")), ids=lambda path: path.stem
)
def test_a_shipped_file_satisfies_the_schema_of_what_is_installed(path: Path) -> None:
    jsonschema.Draft202012Validator(mission_schema()).validate(
        yaml.safe_load(path.read_text(encoding="utf-8"))
    )


@pytest.mark.parametrize("name", ["pick_and_place", "relocate", "map_site"])
def test_a_shipped_mission_loads_and_loads_again_when_written_out(
    name: str, tmp_path: Path
) -> None:
    mission = load_mission(name)
    assert not mission.warnings
    path = tmp_path / "mission.yaml"
    path.write_text(resolved_yaml(mission), encoding="utf-8")
    assert resolved_yaml(load_mission(str(path))) == resolved_yaml(mission)
