"""`--set` is one language: the same words and the same messages for every verb."""

import pytest

from executive.commands.main import main
from executive.errors import ConfigError
from executive.tree.choices import Choices

VERBS = {
    "segmentation": ["segment", "no_cloud.ply"],
    "registration": ["register", "no_cloud.ply", "no_cloud.ply"],
    "alignment": ["align", "no_cloud.ply", "no_cloud.ply"],
    "grasping": ["check", "pick_and_place"],
    "surveying": ["survey", "no_folder", "--out", "cloud.ply"],
}


def ended(monkeypatch: pytest.MonkeyPatch, words: list[str]) -> object:
    monkeypatch.setattr("sys.argv", ["executive", *words])
    with pytest.raises(SystemExit) as caught:
        main()
    return caught.value.code


@pytest.mark.parametrize("capability", VERBS)
def test_a_field_that_does_not_exist_is_refused_before_any_file_is_read(
    capability: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    option = f"{capability}.no_such_field=3"
    assert ended(monkeypatch, [*VERBS[capability], "--set", option]) == 2
    said = capsys.readouterr().err
    assert f"--set {option}: error: " in said
    assert "has no setting 'no_such_field'" in said


@pytest.mark.parametrize("capability", VERBS)
def test_a_plugin_that_is_not_installed_is_refused(
    capability: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    option = f"{capability}.plugin=no_such_plugin"
    assert ended(monkeypatch, [*VERBS[capability], "--set", option]) == 2
    assert f"--set {option}: error: no {capability} plugin" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("option", "says"),
    [
        ("segmentation.plane.max_slope=steep", "--set segmentation.plane.max_slope=steep: error: "),
        ("segmentaton.cell_m=1", "no 'segmentaton' to set. Did you mean 'segmentation'?"),
        ("segmentation", "expected capability.field=value"),
        ("grasping.rehearsed=1", "this command does not use 'grasping'; it uses segmentation"),
        ("loop.tick=1", "this command does not use 'loop'"),
        ("segmentation=[]", "one segmentation plugin is needed, and none is chosen"),
    ],
)
def test_mistakes_are_named(option: str, says: str) -> None:
    def chosen() -> object:
        choices = Choices(("segmentation",), [option])
        return choices.name("segmentation"), choices.selections()

    with pytest.raises(ConfigError) as caught:
        chosen()
    assert says in str(caught.value)


def test_defaults_are_those_of_the_shipped_missions_and_options_go_over_them() -> None:
    choices = Choices(("registration",), ["alignment.plugin=point_to_plane"])
    chosen = {name: [one.name for one in some] for name, some in choices.selections().items()}
    assert chosen == {
        "segmentation": ["ground_and_clusters"],
        "alignment": ["point_to_plane"],
        "registration": ["segment_shot"],
    }
    assert choices.model == "m545"


def test_what_a_command_knows_stands_below_what_is_set() -> None:
    options = ["surveying.plugin=colmap", "surveying.motion.features=300"]
    choices = Choices(("surveying",), options)
    known = {"photographs": "photos", "motion": {"features": 999, "feature_px": 500}}
    settings = choices.selection("surveying", known=lambda _: known).settings.model_dump()
    assert settings["motion"]["features"] == 300
    assert settings["motion"]["feature_px"] == 500
    assert str(settings["photographs"]) == "photos"
