"""Against the real BehaviorTree.CPP: its recorded answers, and itself where it is found."""

import json
from typing import Any

import pytest

from executive.tree.btcpp.import_xml import from_xml

FEW = 60  # trees at random that are played with the library each time


@pytest.fixture
def library(modules: Any) -> Any:
    """Return the library, if its sources are found."""
    real = modules["real"]
    try:
        real.built()
    except real.NotFoundError as error:
        pytest.skip(f"the real BehaviorTree.CPP is not asked: {error}")
    return real


def recorded(compare: Any) -> list[Any]:
    return [json.loads(line) for line in compare.RECORDED.read_text(encoding="utf-8").splitlines()]


def test_random_trees_play_as_the_library_has_played_them(modules: Any) -> None:
    compare, ours, trees = modules["compare"], modules["ours"], modules["random_trees"]
    different = []
    for seed, digest, answer in recorded(compare):
        scene = trees.random_scene(seed)
        assert compare.digest(scene) == digest, "record anew: another tree has this seed"
        played = ours.play(ours.loaded(scene.main, scene.trees), trees.TICKS, scene.halts)
        if not compare.alike(played, answer.split(";"), scene):
            different.append(seed)
    assert different == []


def test_a_tree_comes_back_from_xml_and_plays_as_before(modules: Any) -> None:
    compare, ours, trees = modules["compare"], modules["ours"], modules["random_trees"]
    for seed, _, _ in recorded(compare)[::3]:
        scene = trees.random_scene(seed)
        mission = ours.loaded(scene.main, scene.trees)
        xml = ours.to_xml(mission)
        again = from_xml(xml, "it.xml", ours.CATALOGUE, "again").document["trees"]
        back = ours.loaded(again["main"], {k: v for k, v in again.items() if k != "main"})
        first, second = (ours.play(one, trees.TICKS, scene.halts) for one in (mission, back))
        assert first == second, seed
        assert ours.to_xml(back) == xml, seed


def test_the_xml_is_that_which_the_library_has_taken(modules: Any) -> None:
    accepted = modules["accepted"]
    taken = json.loads(accepted.RECORDED.read_text(encoding="utf-8"))
    assert {name: accepted.digest(xml) for name, xml in accepted.of_cases().items()} == taken


def test_the_xml_of_missions_keeps_the_rules_of_the_library(modules: Any) -> None:
    accepted = modules["accepted"]
    found = {**accepted.shipped(), **accepted.of_cases()}
    assert {name: told for name, xml in found.items() if (told := accepted.objections(xml))} == {}


def test_the_library_takes_the_xml(modules: Any, library: Any) -> None:
    found = {**modules["accepted"].shipped(), **modules["accepted"].of_cases()}
    answers = library.answers([library.Scene(xml, ticks=0) for xml in found.values()])
    refused = [name for name, one in zip(found, answers, strict=True) if "error" in one]
    assert refused == []


def refused_before() -> tuple[str, str]:
    """Return a leaf in long form under ReactiveSequence, and two SubTrees of one name."""
    model = '<TreeNodesModel><Action ID="A"/></TreeNodesModel></root>'
    head = '<root BTCPP_format="4" main_tree_to_execute="m"><BehaviorTree ID="m">'
    long = f'{head}<ReactiveSequence><Action ID="A"/></ReactiveSequence></BehaviorTree>{model}'
    call = '<SubTree ID="s" name="x"/>'
    called = '</BehaviorTree><BehaviorTree ID="s"><A/></BehaviorTree>'
    twice = f"{head}<Sequence>{call}{call}</Sequence>{called}{model}"
    return long, twice


def test_what_was_refused_before_is_against_the_rules(modules: Any) -> None:
    assert all(modules["accepted"].objections(xml) for xml in refused_before())


def test_the_library_refuses_what_it_refused_before(library: Any) -> None:
    answers = library.answers([library.Scene(xml) for xml in refused_before()])
    assert ["error" in one for one in answers] == [True, True]


def test_the_library_plays_trees_at_random_alike(modules: Any, library: Any) -> None:
    compare, ours, trees = modules["compare"], modules["ours"], modules["random_trees"]
    scenes = [trees.random_scene(10_000 + number) for number in range(FEW)]
    missions = [ours.loaded(one.main, one.trees) for one in scenes]
    given = [
        library.Scene(trees.scene_xml(mission), trees.TICKS, 100, scene.halts)
        for mission, scene in zip(missions, scenes, strict=True)
    ]
    for scene, mission, answer in zip(scenes, missions, library.answers(given), strict=True):
        played = ours.play(mission, trees.TICKS, scene.halts)
        assert compare.alike(played, answer["ticks"], scene), json.dumps(scene.main)
