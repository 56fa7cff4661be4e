"""A campaign file: what each part says, and that every mistake is reported at its place."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from executive.campaign.description.campaign import Campaign
from executive.campaign.description.load import is_campaign_folder, load_asked, load_campaign
from executive.campaign.description.metrics import MAIN
from executive.campaign.description.reader import digest_of
from executive.campaign.figures.bound import Bound
from executive.campaign.figures.comparison import Comparison
from executive.campaign.trial import Limits
from executive.tree.problem import MissionFileError

TEN = Path(__file__).with_name("ten_mistakes.yaml")
HEAD = "api: 1\ncampaign: one\n"
Read = Callable[..., Campaign]
Mistakes = Callable[..., list[str]]


def plugins_of(campaign: Campaign, number: int) -> dict:
    """Return the plugins of the resolved mission that a trial is given."""
    return yaml.safe_load(campaign.trials[number].arguments["mission"])["plugins"]


def levels_of(campaign: Campaign) -> list[tuple[int, ...]]:
    return [(one.seed, *one.levels.values()) for one in campaign.trials]


# --- mistakes


def test_ten_mistakes_get_ten_messages_each_with_place_and_cure() -> None:
    with pytest.raises(MissionFileError) as caught:
        load_campaign(str(TEN))
    found = {problem.mark.line: problem.message for problem in caught.value.problems}
    cures = {
        5: "Did you mean 'seeds'?",
        6: "write 1990:2001",
        8: "Did you mean 'count'?",
        10: "Did you mean 'sampled_antipodal'?",
        11: "expected a data size (a number in B, or with a unit: B, MB, GB, MiB, GiB)",
        13: "Did you mean 'success'?",
        14: "write 'at_least' or 'at_most' without 'median'",
        15: "expected a time",
        17: "Did you mean 'sampled_cnn'?",
    }
    assert len(caught.value.problems) == 10  # two of them in line 11
    assert {problem.mark.file.rpartition("/")[2] for problem in caught.value.problems} == {TEN.name}
    assert found.keys() == cures.keys()
    for line, cure in cures.items():
        assert cure in found[line]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("seeds: []", "4:8 'seeds' takes a list of at least one item"),
        ("seeds: [1, -2]", "4:12 a seed is a whole number from 0, or a range such as 1:20, not -2"),
        ("seeds: ['1:3', 2]", "4:16 seed 2 is given twice"),
        ("seeds: 0:99999999", "4:8 more than 1,000,000 seeds"),
        (f"seeds: 0:{'9' * 5000}", "4:8 a seed is a whole number from 0, or a range such as 1:20"),
        ("seeds: 1\nfaults: x", "5:1 a campaign file has no 'faults'"),
        ("seeds: 1\nvariants: {}", "5:11 factor 'variant' needs at least one level"),
        ("seeds: 1\nfactors: {x: [1]}", "5:11 a list of values belongs to a setting"),
        ("seeds: 1\nfactors: {loop.tick: [[1]]}", "5:23 name the levels"),
        ("seeds: 1\nfactors: {loop.tick: [0.1, 0.1]}", "5:28 two levels are called '0.1'"),
        ("seeds: 1\nset: {loop..tick: 1}", "5:7 a setting is capability.field"),
        ("seeds: 1\nset: {robt.model: x}", "5:7 no 'robt' to set. Did you mean 'robot'?"),
        ("seeds: 1\narguments: {}", "5:1 no 'arguments' here: missions take settings"),
        ("seeds: 1\nwork: misson", "5:7 no work plugin 'misson'. Did you mean 'mission'?"),
        ("seeds: 1\nlimits: {time: 0}", "5:16 'time' must be more than 0 s"),
        ("seeds: 1\nlimits: {memory: [4]}", "5:18 'memory' is a size such as 4 GB, not a list"),
        ("seeds: 1\nlimits: {memory: 4 s}", "5:18 'memory': "),
        ("seeds: 1\nlimits: {memory: 4}", "5:18 'memory' must be at least 100 MB"),
        ("seeds: 1\nmetrics: [sucess]", "5:11 no metric plugin 'sucess'. Did you mean 'success'?"),
        ("seeds: 1\nmetrics: {success: {at_least: 95}}", "5:31 'at_least' is a share from 0 to 1"),
        ("seeds: 1\nmetrics: {success: {at_last: 1}}", "5:21 'success' has no 'at_last'"),
        ("seeds: 1\nmetrics: {cycle_time: {at_most: 1}}", "5:24 'cycle_time' has values: say of"),
        ("seeds: 1\nmetrics: {cycle_time: {mean: 1}}", "5:24 'cycle_time' has no 'mean'"),
        ("seeds: 1\nmetrics: {success: {where: {}}}", "5:20 'where' says for which levels"),
        ("seeds: 1\nmetrics: {success: {except: {}}}", "5:20 'except' says for which levels"),
        ("seeds: 1\ncompare: {factor: x}", "5:10 'compare' takes a list"),
        ("seeds: 1\ncompare: [{factor: x}]", "5:11 a comparison needs 'baseline'"),
    ],
)
def test_a_mistake_is_reported_at_its_place(text: str, message: str, mistakes: Mistakes) -> None:
    told = mistakes(f"\n{text}\n", f"{HEAD}missions: waits.yaml")
    assert told[0].startswith(message)


def test_what_is_missing_is_reported(mistakes: Mistakes) -> None:
    assert mistakes("description: x\n", "") == [
        "1:1 'api' is missing; write 'api: 1'",
        "1:1 'campaign' is missing: the campaign's name",
        "1:1 'missions' is missing: files, or names of shipped missions",
        "1:1 'seeds' is missing: 1:20 are twenty seeds; --seeds gives them on the command line",
    ]


def test_a_mission_that_is_not_there_is_reported_with_the_nearest(mistakes: Mistakes) -> None:
    (told,) = mistakes("missions: [waits.yaml, ./othr.yaml]\n", f"{HEAD}seeds: 1\n")
    assert told == "4:24 no file and no shipped mission './othr.yaml'. Did you mean 'other.yaml'?"


@pytest.mark.parametrize("name", ["x" * 300, f"{'x' * 300}/waits.yaml"])
def test_a_mission_of_an_impossible_name_is_reported(name: str, mistakes: Mistakes) -> None:
    (told,) = mistakes(f'missions: ["{name}"]\n', f"{HEAD}seeds: 1\n")
    assert told.startswith("4:12 no file and no shipped mission ")


def test_a_mistake_within_a_mission_is_reported_there(read: Read, folder: Path) -> None:
    (folder / "waits.yaml").write_text((folder / "waits.yaml").read_text().replace("1 s", "1 kg"))
    with pytest.raises(MissionFileError, match=r"waits\.yaml:8:16: error: .*'kg' is not a unit"):
        read("")


def test_answers_that_no_mission_takes_and_questions_left_open_are_refused(
    mistakes: Mistakes, asking: Path
) -> None:
    head = f"{HEAD}missions: [waits.yaml, {asking.name}]\nseeds: 1\n"
    assert mistakes("answers: [true]\n", head) == [
        "3:24 asks asks 'How?', and nobody is there to answer: put slowly or quickly under "
        "'answers', or give the question a default",
    ]
    told = mistakes("answers: [true, false, slowli, slowly]\n", head)
    assert told == [
        "5:17 true and false are both given; questions of yes or no take one of them",
        "5:24 no question of the campaign's missions takes 'slowli'. Did you mean 'slowly'?",
    ]


def test_two_factors_that_set_the_same_are_refused(mistakes: Mistakes) -> None:
    text = "factors: {loop.tick: [0.1, 0.2], a: {x: {loop.tick: 0.3}, y: {mission: other.yaml}}}\n"
    told = mistakes(text)
    assert told == [
        "5:42 'loop.tick' is set by the factor 'loop.tick' already",
        "5:72 'mission' is set by the factor 'mission' already",
    ]


def test_factors_beside_variants_are_refused(mistakes: Mistakes) -> None:
    told = mistakes("factors: {loop.tick: [0.1, 0.2]}\nvariants: {a: {}}\n")
    assert told == [
        "6:1 'factors' and 'variants' exclude each other; write the variants as a factor"
    ]


# --- what a file says


def test_each_mission_gets_the_answers_that_its_questions_take(read: Read, asking: Path) -> None:
    head = f"{HEAD}missions: [waits.yaml, {asking.name}]\nseeds: 1\n"
    campaign = read("answers: [slowly, false]\n", head)
    answers = [one.arguments.get("answers") for one in campaign.trials]
    assert answers == [None, ["slowly", "no"]]


def test_seeds_are_a_number_a_range_or_a_list(read: Read) -> None:
    head = f"{HEAD}missions: waits.yaml\n"
    for text, seeds in (("3", [3]), ("98:101", [98, 99, 100, 101]), ('["1:3", 9]', [1, 2, 3, 9])):
        assert [one.seed for one in read(f"seeds: {text}\n", head).trials] == seeds


def test_trials_are_ordered_seed_by_seed(read: Read) -> None:
    text = "seeds: [5, 4]\nfactors: {loop.tick: [0.1, 0.2], a: {x: , y: {loop.runner: thread}}}\n"
    campaign = read(text, f"{HEAD}missions: waits.yaml\n")
    cells = [("0.1", "x"), ("0.1", "y"), ("0.2", "x"), ("0.2", "y")]
    assert levels_of(campaign) == [(seed, *cell) for seed in (5, 4) for cell in cells]
    assert [one.number for one in campaign.trials] == list(range(8))
    assert campaign.factors == {"loop.tick": ("0.1", "0.2"), "a": ("x", "y")}


def test_every_cell_has_its_settings(read: Read) -> None:
    text = """
set: {robot.model: m545, loop.tick: 0.2}
factors:
  speed: {slow: {loop.tick: 0.1}, usual: {}}
  loop.runner: [inline, thread]
"""
    campaign = read(text)
    loops = [yaml.safe_load(one.arguments["mission"])["loop"] for one in campaign.trials]
    found = [(loop["tick"], loop["runner"]) for loop in loops]
    assert found == [(0.1, "inline"), (0.1, "thread"), (0.2, "inline"), (0.2, "thread")]


def test_a_plugin_is_chosen_before_its_settings_whatever_their_order(read: Read) -> None:
    text = """
set: {estimation.process: false, robot.model: m545}
factors: {estimation.plugin: [dual_graph]}
"""
    estimation = plugins_of(read(text), 0)["estimation"]
    assert (estimation["plugin"], estimation["process"]) == ("dual_graph", False)


def test_variants_are_one_factor_and_may_have_missions_of_their_own(read: Read) -> None:
    text = "variants: {short: {mission: waits.yaml}, long: {mission: other.yaml}}\n"
    campaign = read(text, f"{HEAD}seeds: 1\n")
    assert campaign.factors == {"variant": ("short", "long")}
    waits = [yaml.safe_load(one.arguments["mission"])["trees"]["main"] for one in campaign.trials]
    assert waits == [{"wait": 1.0}, {"wait": 2.0}]


def test_several_missions_are_a_factor_and_one_is_none(read: Read) -> None:
    several = read("missions: [waits.yaml, ./other.yaml]\n", f"{HEAD}seeds: 1\n")
    assert several.factors == {"mission": ("waits", "other")}
    assert [one.levels for one in several.trials] == [{"mission": "waits"}, {"mission": "other"}]
    alone = read("")
    assert (alone.factors, alone.trials[0].levels) == ({}, {})


def test_limits_have_units(read: Read) -> None:
    limits = read("limits: {time: 20 min, memory: 2 GiB}\n").trials[0].limits
    assert limits == Limits(1200.0, 2 * 2**30)
    assert read("").trials[0].limits == Limits(3600.0, 8_000_000_000)


def test_bounds_are_of_statistics_and_levels(read: Read) -> None:
    campaign = read("""
factors: {a: {x: {}, y: {loop.tick: 0.2}}}
metrics:
  success: [{at_least: 95 %, where: {a: x}}, {at_least: 0.5}]
  placement_error: {median: {at_most: 10 cm}, p95: {at_least: 0, at_most: 0.3}}
  cycle_time:
  peak_memory: {max: {at_most: 2 GB}}
""")
    assert campaign.metrics == ("success", "placement_error", "cycle_time", "peak_memory")
    assert campaign.bounds == (
        Bound("success", "share", 0.95, True, {"a": "x"}),
        Bound("success", "share", 0.5, True),
        Bound("placement_error", "median", 0.1, False),
        Bound("placement_error", "p95", 0.0, True),
        Bound("placement_error", "p95", 0.3, False),
        Bound("peak_memory", "max", 2e9, False),
    )


def test_without_metrics_all_installed_ones_are_reported(read: Read) -> None:
    campaign = read("factors: {loop.tick: [0.1, 0.2]}\n")
    assert {"success", "cycle_time", "peak_memory"} <= set(campaign.metrics)
    assert campaign.comparisons == (Comparison("loop.tick", "0.1", MAIN, 0.05),)
    assert read("metrics: [placed]\n").metrics == ("placed",)


def test_comparisons_are_as_given(read: Read) -> None:
    text = """
factors: {loop.tick: [0.1, 0.2], a: {x: {}, y: {loop.runner: thread}}}
metrics: [success, placed]
"""
    both = ("success", "placed")
    first = (Comparison("loop.tick", "0.1", both, 0.05), Comparison("a", "x", both, 0.05))
    assert read(text).comparisons == first
    assert read(f"{text}compare: []\n").comparisons == ()
    given = "compare: [{factor: loop.tick, baseline: 0.2, metrics: [placed], margin: 2 %}]\n"
    assert read(text + given).comparisons == (Comparison("loop.tick", "0.2", ("placed",), 0.02),)


def test_comparing_what_is_not_reported_is_refused(mistakes: Mistakes) -> None:
    text = "factors: {loop.tick: [0.1, 0.2]}\nmetrics: [success]\n"
    wrong = "compare: [{factor: loop.tik, baseline: 0.3, metrics: [placed]}]\n"
    assert mistakes(text + wrong) == [
        "7:20 no factor 'loop.tik'. Did you mean 'loop.tick'?",
        "7:55 'placed' is not reported; add it to 'metrics'",
    ]


def test_relative_paths_are_of_the_campaign_file(read: Read, folder: Path) -> None:
    plugin = "surveying: {plugin: point_cloud_file, path: clouds/b.ply}"
    text = f"set: {{{plugin}}}\nfactors: {{surveying.path: [clouds/a.ply, /b.ply]}}\n"
    text = text.replace(", path: clouds/b.ply", "")
    campaign = read(text)
    paths = [plugins_of(campaign, number)["surveying"]["path"] for number in (0, 1)]
    assert paths == [str(folder / "clouds" / "a.ply"), "/b.ply"]
    assert campaign.factors["surveying.path"] == ("clouds/a.ply", "/b.ply")


def test_relative_paths_of_a_mission_are_of_the_current_folder_as_in_a_run(
    read: Read,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    plugin = "  surveying: {plugin: point_cloud_file, path: clouds/own.ply}\n"
    mission = (folder / "waits.yaml").read_text().replace("trees:", f"{plugin}trees:")
    (folder / "waits.yaml").write_text(mission)
    here = tmp_path_factory.mktemp("here")
    monkeypatch.chdir(here)
    own, given = (read(text) for text in ("", "set: {surveying.path: given.ply}\n"))
    assert plugins_of(own, 0)["surveying"]["path"] == str(here / "clouds" / "own.ply")
    assert plugins_of(given, 0)["surveying"]["path"] == str(folder / "given.ply")


# --- the same again


def test_the_digest_tells_trials_apart_and_nothing_else(read: Read, folder: Path) -> None:
    one = read("set: {loop.tick: 0.2}\n")
    assert one.digest == digest_of(one.trials)
    alike = "description: other\nset: {loop.tick: 200 ms}\nlimits: {time: 5 s}\nmetrics: [success]"
    assert read(alike).digest == one.digest
    assert read("set: {loop.tick: 0.3}\n").digest != one.digest
    assert read("set: {loop.tick: 0.2}\n", seeds="8").digest != one.digest
    (trial, *_) = one.trials
    two = {"b": {"d": 1, "c": 2}, "a": 3}
    turned = {"a": 3, "b": {"c": 2, "d": 1}}
    digests = {
        digest_of([replace(trial, arguments=order, levels=order)]) for order in (two, turned)
    }
    assert len(digests) == 1
    assert digests != {digest_of([replace(trial, arguments=two, levels={})])}
    (folder / "waits.yaml").write_text((folder / "other.yaml").read_text())
    assert read("set: {loop.tick: 0.2}\n").digest != one.digest


def test_the_kept_file_gives_the_same_campaign_in_any_folder(
    read: Read, folder: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    text = """
description: What does a shorter tick cost?
missions: [waits.yaml, other.yaml]
set: {surveying.plugin: point_cloud_file, surveying.path: here/a.ply}
factors: {loop.tick: [0.1, 0.2]}
metrics: {success: {at_least: 0.9, where: {mission: other}}}
compare: [{factor: mission, baseline: waits}]
"""
    first = read(text, HEAD, seeds="1:2,9", settings=("loop.runner=thread",), time_limit="5 min")
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (elsewhere / "campaign.yaml").write_text(first.text)
    again = load_campaign(str(elsewhere))
    assert again == first
    assert len(first.trials) == 12


def test_what_a_campaign_asked_for_is_read_without_its_missions(read: Read, folder: Path) -> None:
    text = "factors: {loop.tick: [0.1, 0.2]}\nmetrics: {success: {at_least: 0.9}}\n"
    first = read(text)
    results = folder / "results"
    results.mkdir()
    (results / "campaign.yaml").write_text(first.text)
    (folder / "waits.yaml").unlink()
    asked = load_asked(results, "executive campaign …")
    assert (asked.trials, asked.command) == ((), "executive campaign …")
    for name in ("name", "factors", "metrics", "bounds", "comparisons"):
        assert getattr(asked, name) == getattr(first, name)


def test_a_folder_of_a_shipped_missions_name_does_not_hide_the_mission(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "relocate").mkdir()
    assert not is_campaign_folder("relocate")
    (tmp_path / "relocate" / "campaign.yaml").touch()
    assert is_campaign_folder("relocate")
