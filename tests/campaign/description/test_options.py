"""Options of the command line, over a campaign file and over a mission."""

from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from executive.campaign.description.campaign import Campaign
from executive.campaign.description.load import load_campaign
from executive.campaign.description.options import CampaignOptions
from executive.campaign.trial import Limits
from executive.tree.problem import MissionFileError

Read = Callable[..., Campaign]


def test_a_mission_with_options_is_a_campaign(folder: Path) -> None:
    options = CampaignOptions(
        seeds="1:2,31",
        settings=("loop.runner=thread",),
        vary=("loop.tick=0.1,0.2",),
        time_limit="20 min",
        memory_limit="2 GB",
    )
    campaign = load_campaign(str(folder / "waits.yaml"), options, "executive campaign …")
    assert (campaign.name, campaign.command) == ("waits", "executive campaign …")
    assert [one.seed for one in campaign.trials] == [1, 1, 2, 2, 31, 31]
    assert campaign.factors == {"loop.tick": ("0.1", "0.2")}
    assert campaign.trials[0].limits == Limits(1200.0, 2_000_000_000)
    assert yaml.safe_load(campaign.trials[1].arguments["mission"])["loop"]["runner"] == "thread"
    assert [one.baseline for one in campaign.comparisons] == ["0.1"]


def test_options_go_over_a_campaign_file(read: Read) -> None:
    text = "set: {loop.tick: 0.1}\nlimits: {time: 1 s, memory: 1 GB}\nfactors: {a: {x: {}}}\n"
    campaign = read(
        text,
        seeds="3",
        settings=("loop.tick=0.4",),
        vary=("loop.runner=inline,thread",),
        time_limit="7",
    )
    assert [one.seed for one in campaign.trials] == [3, 3]
    assert yaml.safe_load(campaign.trials[0].arguments["mission"])["loop"]["tick"] == 0.4
    assert campaign.trials[0].limits == Limits(7.0, 1_000_000_000)


def test_relative_paths_of_options_are_of_the_current_folder(
    read: Read, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    here = tmp_path_factory.mktemp("here")
    monkeypatch.chdir(here)
    settings = ("surveying.plugin=point_cloud_file", "surveying.path=a.ply")
    mission = yaml.safe_load(read("", settings=settings).trials[0].arguments["mission"])
    assert mission["plugins"]["surveying"]["path"] == str(here / "a.ply")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"seeds": "1:x"}, "--seeds 1:x: error: a seed is a whole number"),
        ({"seeds": ""}, "--seeds : error: a seed is a whole number"),
        ({"settings": ("loop.tick",)}, "--set loop.tick: error: expected capability.field=value"),
        ({"settings": ("loop.tik=1",)}, "--set loop.tik=1: error: loop has no setting 'tik'. Did"),
        ({"vary": ("loop.tick=",)}, "--vary loop.tick=: error: expected capability.field=a,b,c"),
        ({"vary": ("tick=1,2",)}, "--vary tick=1,2: error: a list of values belongs to a setting"),
        ({"vary": ("loop.tick=1,}",)}, "--vary loop.tick=1,}: error: "),
        ({"time_limit": "4 GB"}, "--time-limit 4 GB: error: 'time': 'GB' is not a unit of time"),
        ({"memory_limit": "4"}, "--memory-limit 4: error: 'memory' must be at least 100 MB"),
    ],
)
def test_a_mistake_names_the_option(read: Read, options: dict, message: str) -> None:
    with pytest.raises(MissionFileError) as caught:
        read("", **options)
    assert str(caught.value).startswith(message)


def test_what_is_neither_file_nor_mission_is_refused_with_the_nearest() -> None:
    with pytest.raises(MissionFileError, match="Did you mean 'pick_and_place'"):
        load_campaign("pick_and_plac")


def test_a_folder_without_a_campaign_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MissionFileError, match=r"campaign\.yaml: error: cannot be read"):
        load_campaign(str(tmp_path))
