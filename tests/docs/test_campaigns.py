"""The page on campaigns is true: its file has no mistake, and its tables are complete."""

import re
from pathlib import Path

import pytest
import yaml

from executive.campaign.description.load import load_campaign
from executive.campaign.description.metrics import MAIN, OF_VALUES
from executive.campaign.description.reader import KEYS
from executive.campaign.description.schema import campaign_schema
from executive.campaign.trial import Limits, Status

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "campaigns.md").read_text(encoding="utf-8")
OWN = sorted((ROOT / "docs" / "campaigns").glob("*.yaml"))
FILE = re.search(r"```yaml\n(.*?)```", PAGE, re.S).group(1)


def test_its_file_is_a_campaign_that_the_schema_takes(tmp_path: Path) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    path = tmp_path / "grasping.yaml"
    path.write_text(FILE)
    campaign = load_campaign(str(path))
    assert len(campaign.trials) == 80
    assert campaign.trials[0].limits == Limits(1200.0, 4_000_000_000)
    assert len(campaign.bounds) == 6
    scans = yaml.safe_load(campaign.trials[2].arguments["mission"])["plugins"]["robot"]
    assert scans["site"]["stones"]["folder"] == str(tmp_path / "stones")
    jsonschema.Draft202012Validator(campaign_schema()).validate(yaml.safe_load(FILE))


def test_every_key_of_a_campaign_file_is_in_its_table_or_is_a_title() -> None:
    rows = re.findall(r"^\| ((?:`\w+`(?:, )?)+) \|", PAGE, re.M)
    named = {key for row in rows for key in re.findall(r"\w+", row)}
    assert set(KEYS) - named == {"api", "campaign", "description"}
    assert FILE.startswith("api: 1\ncampaign: ")


def test_its_words_are_those_of_the_code() -> None:
    named = set(re.findall(r"`([\w.]+)`", PAGE))
    assert set(MAIN) <= named
    assert set(OF_VALUES) <= named
    statuses = re.search(r"--again timed_out +# repeats these runs; also (.*), or failed", PAGE)
    others = {one.value for one in Status} - {"done", "timed_out"}
    assert set(statuses.group(1).split(", ")) == others


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.stem)
def test_the_projects_own_campaigns_have_no_mistake(path: Path) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    campaign = load_campaign(str(path))
    assert campaign.name == path.stem
    assert campaign.description
    validator = jsonschema.Draft202012Validator(campaign_schema())
    validator.validate(yaml.safe_load(path.read_text(encoding="utf-8")))
