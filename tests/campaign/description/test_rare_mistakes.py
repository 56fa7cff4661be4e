"""Mistakes of campaign files that are seldom made, and limits that are just right."""

from collections.abc import Callable
from pathlib import Path

import pytest
from pydantic import BaseModel

from executive import registry
from executive.campaign.description import grid, reader
from executive.campaign.description.campaign import Campaign
from executive.campaign.description.factors import _meet
from executive.campaign.description.load import is_campaign_folder
from executive.campaign.description.metrics import parse_in_unit
from executive.campaign.description.paths import part_at, relative_paths
from executive.campaign.figures.bound import Bound
from executive.interfaces.plugin import Plugin
from executive.tree.document import read_text
from executive.tree.problem import Problems

Read = Callable[..., Campaign]
Mistakes = Callable[..., list[str]]
TWO = "factors: {loop.tick: [0.1, 0.2]}\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("metrics: {success: {median: {at_most: 1}}}\n", "6:21 'success' is a share: write"),
        ("metrics: {cycle_time: {median: {at_most: [1]}}}\n", "6:42 'at_most': a number, not a l"),
        ("metrics: {cycle_time: {median: {at_most: 5 kg}}}\n", "6:42 'at_most': "),
        ("metrics: {success: {at_least: many %}}\n", "6:31 'at_least' is a share from 0 to 1"),
        ("metrics: {success: {at_least: true}}\n", "6:31 'at_least' is a share from 0 to 1"),
        ("metrics: {success: {at_least: [1]}}\n", "6:31 'at_least' is a share from 0 to 1"),
        ("metrics: {success: {at_least: -0.01}}\n", "6:31 'at_least' is a share from 0 to 1"),
        (
            "metrics: {success: {at_least: 1, where: {loop.tick: [0.1]}}}\n",
            "6:53 a level is a name, not a list",
        ),
        (
            "metrics: {success: {at_least: 1, except: {loop.tick: 0.3}}}\n",
            "6:54 factor 'loop.tick' has no level '0.3'",
        ),
        (
            "metrics: {success: {at_least: 1, where: {loop.tik: 0.1}}}\n",
            "6:42 'where' has no 'loop.tik'. Did you mean 'loop.tick'?",
        ),
        ("compare: [{baseline: '0.1'}]\n", "6:11 a comparison needs 'factor': what is compared"),
        (
            "compare: [{factor: loop.tick, baseline: '0.1', metrics: [sucess]}]\n",
            "6:58 no metric 'sucess'. Did you mean 'success'?",
        ),
        (
            "metrics: [placed]\ncompare: [{factor: loop.tick, baseline: '0.1', "
            "metrics: [success]}]\n",
            "7:58 'success' is not reported; add it to 'metrics'",
        ),
    ],
)
def test_a_rare_mistake_is_reported_at_its_place(
    text: str, message: str, mistakes: Mistakes
) -> None:
    told = mistakes(f"{TWO}{text}")
    assert any(one.startswith(message) for one in told), told


@pytest.mark.parametrize(
    ("given", "limit"),
    [("0", 0.0), ("1", 1.0), ("95 %", 0.95), ("0.5", 0.5), ("100%", 1.0)],
)
def test_a_share_is_a_number_or_a_percentage_up_to_its_ends(
    given: str, limit: float, read: Read
) -> None:
    assert read(f"metrics: {{success: {{at_least: {given}}}}}\n").bounds == (
        Bound("success", "share", limit, True),
    )


def test_a_bound_may_be_for_some_levels_and_not_for_others(read: Read) -> None:
    text = f"{TWO}metrics: {{success: [{{at_most: 1, where: {{loop.tick: 0.1}}}}, {{at_least: 0.5, "
    campaign = read(f"{text}except: {{loop.tick: 0.2}}}}]}}\n")
    first, second = campaign.bounds
    assert (first.where, first.excepted, first.is_least) == ({"loop.tick": "0.1"}, {}, False)
    assert (second.where, second.excepted, second.is_least) == ({}, {"loop.tick": "0.2"}, True)


def test_a_quantity_is_in_the_unit_of_its_metric() -> None:
    assert parse_in_unit("2 min", "s") == 120.0
    assert parse_in_unit("1 GB", "byte") == 1e9
    assert parse_in_unit(3, "s") == 3.0
    assert parse_in_unit(3, "") == 3.0
    for value in (True, float("nan"), None, "3 m"):
        with pytest.raises(ValueError, match="expected a"):
            parse_in_unit(value, "s")
    with pytest.raises(ValueError, match="expected a number, got '3'"):
        parse_in_unit("3", "")


def test_the_most_combinations_and_the_most_runs_are_taken_and_one_more_is_refused(
    read: Read, mistakes: Mistakes, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "factors: {loop.tick: [0.1, 0.2], loop.runner: [inline, thread]}\n"
    monkeypatch.setattr(grid, "MOST_CELLS", 4)
    monkeypatch.setattr(reader, "MOST", 4)
    assert len(read(text).trials) == 4
    monkeypatch.setattr(reader, "MOST", 3)
    assert mistakes(text) == ["1:1 more than 3 runs"]
    monkeypatch.setattr(grid, "MOST_CELLS", 3)
    assert mistakes(text)[0] == "1:1 the factors make more than 3 combinations of levels"


def test_a_work_that_is_none_is_told_by_its_class(
    mistakes: Mistakes, monkeypatch: pytest.MonkeyPatch
) -> None:
    load = registry.load
    monkeypatch.setattr(
        registry,
        "load",
        lambda group, name: Plugin if group == registry.WORKS else load(group, name),
    )
    told = mistakes("work: odd\n", "api: 1\ncampaign: one\nseeds: 1\n")
    assert any("work 'odd' (Plugin) is no Work" in one for one in told)


def test_a_name_that_no_file_can_have_is_no_campaigns_folder(tmp_path: Path) -> None:
    assert not is_campaign_folder("a\0b")
    assert not is_campaign_folder(str(tmp_path / "none"))
    assert is_campaign_folder(str(tmp_path))
    assert not is_campaign_folder("pick_and_place")


class Site(BaseModel):
    log: Path
    label: str = ""
    several: tuple[Path, ...] = ()


def found_in(text: str, checked: object) -> list[str]:
    value = read_text(text, "f", Problems())
    assert value is not None
    return [path for _, path in relative_paths(value, checked)]


def test_relative_paths_are_those_of_path_fields_and_texts_that_begin_with_a_dot() -> None:
    site = Site(log="a.mcap", label="b", several=("c", "/d", "e"))  # type: ignore[arg-type]
    text = "{log: a.mcap, label: b, several: [c, /d, e]}"
    assert found_in(text, site) == ["a.mcap", "c", "e"]
    assert found_in("{log: /a.mcap, label: ./b, more: ../x}", site) == ["./b", "../x"]
    assert found_in("[[./a], b, 3]", None) == ["./a"]
    assert found_in("{several: [c, d, e, f]}", {"several": [Path("c"), "d"]}) == ["c"]


@pytest.mark.parametrize(
    ("path", "part"),
    [("", {"site": Site(log=Path("a"))}), ("site.log", Path("a")), ("site.lgo", None),
     ("sit.log", None), ("site.log.more", None)],
)  # fmt: skip
def test_a_part_of_settings_is_found_by_its_path(path: str, part: object) -> None:
    assert part_at({"site": Site(log=Path("a"))}, path) == part


@pytest.mark.parametrize(
    ("one", "other", "meet"),
    [
        ("loop.tick", "loop.tick", True),
        ("robot.site", "robot.site.stones", True),
        ("robot.site.stones", "robot.site", True),
        ("robot.site", "robot.sites", False),
        ("loop.tick", "loop.runner", False),
    ],
)
def test_a_setting_meets_those_above_and_below_it(one: str, other: str, meet: bool) -> None:
    assert _meet(one, other) is meet
