"""The JSON schema of campaign files: it takes what loads, and marks what an editor can know."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from executive import registry
from executive.campaign.description.schema import campaign_schema

jsonschema = pytest.importorskip("jsonschema")

TEN = Path(__file__).with_name("ten_mistakes.yaml")
GOOD = """
api: 1
campaign: good
description: Everything that a file can say.
missions: [pick_and_place, ./own.yaml]
seeds: [2001:2020, 7]
set: {robot.site.stones.count: 7, loop.tick: 0.05}
factors:
  stones:
    generated:
    scans: {robot.site.stones.folder: ../stones, robot.site.stones.scale: 10}
    other: {mission: ./other.yaml}
  grasping.plugin: [sampled_cnn, sampled_antipodal]
limits: {time: 20 min, memory: 4 GB}
metrics:
  success: [{at_least: 95 %, where: {stones: scans}}, {at_least: 0.9, except: {stones: scans}}]
  placement_error: {median: {at_most: 0.10 m}}
  cycle_time:
compare:
  - {factor: stones, baseline: generated, metrics: [success], margin: 0.1}
"""


@pytest.fixture(scope="module")
def validator() -> Any:
    return jsonschema.Draft202012Validator(campaign_schema())


def test_it_is_a_json_schema(validator: Any) -> None:
    validator.check_schema(validator.schema)


def test_it_takes_what_a_file_can_say(validator: Any) -> None:
    validator.validate(yaml.safe_load(GOOD))


def test_it_knows_settings_by_their_dotted_keys(validator: Any) -> None:
    settings = validator.schema["$defs"]["settings"]["properties"]
    assert settings["robot.site.stones.count"]["description"] == "Number of stones."
    assert "sampled_cnn" in settings["grasping.plugin"]["enum"]


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("api: 1", "api: 2"),
        ("seeds:", "sedes:"),
        ("2001:2020", "2001-2020"),
        ("loop.tick: 0.05", "loop.runner: sideways"),
        ("[sampled_cnn,", "[sampled_cn,"),
        ("success: [", "sucess: ["),
        ("95 %", "95"),
        ("median:", "mean:"),
        ("margin: 0.1", "margin: 2"),
        ("baseline:", "basis:"),
    ],
)
def test_it_marks_a_mistake(right: str, wrong: str, validator: Any) -> None:
    assert right in GOOD
    document = yaml.safe_load(GOOD.replace(right, wrong))
    assert not validator.is_valid(document)


@pytest.mark.parametrize(
    ("left_out", "least"),
    [("api: 1\n", False), ("campaign: good\n", False), ("factor: stones, ", False),
     ("baseline: generated, ", False), (", margin: 0.1", True), ("metrics: [success], ", True),
     ("description: Everything that a file can say.\n", True)],
)  # fmt: skip
def test_it_knows_which_fields_have_to_be_given(left_out: str, least: bool, validator: Any) -> None:
    assert left_out in GOOD
    assert validator.is_valid(yaml.safe_load(GOOD.replace(left_out, ""))) == least


def test_it_marks_a_file_with_mistakes(validator: Any) -> None:
    assert not validator.is_valid(yaml.safe_load(TEN.read_text()))


def test_a_capability_takes_the_plugins_that_are_installed() -> None:
    known = campaign_schema()["$defs"]["settings"]["properties"]
    assert set(known["segmentation.plugin"]["enum"]) == set(registry.names("segmentation"))
    assert set(known["estimation.plugin"]["enum"]) == set(registry.names("estimation"))
