"""Options that are numbers are refused beyond their bounds, and taken at them."""

import pytest

from executive.commands import main, verbs
from tests.commands.in_process import executive

CLOUDS = ("a.ply", "b.ply")


@pytest.mark.parametrize(
    ("words", "option", "taken", "refused"),
    [
        (("run", "yard", "--dry"), "--groot-port", (1, 65534), (0, 65535)),
        (("run", "yard", "--dry"), "--live-port", (1, 65534), (0, 65535)),
        (("resume", "runs/none"), "--groot-port", (1, 65534), (0, 65535)),
        (("resume", "runs/none"), "--live-port", (1, 65534), (0, 65535)),
        (("run", "yard", "--dry"), "--failures", (0, 1), (-0.01, 1.01)),
        (("run", "yard", "--dry"), "--runs", (1, 100000), (0, -1)),
        (("run", "yard", "--dry"), "--at-least", (0, 100), (-0.1, 100.1)),
        (("run", "yard"), "--seed", (0, 2**40), (-1,)),
        (("coverage", "runs/none"), "--at-least", (0, 100), (-0.1, 100.1)),
        (("place", "stones", "wall.yaml"), "--budget", (0, 1e9), (-0.1,)),
        (("align", *CLOUDS), "--reach", (0.01, 10), (0.009, 10.1)),
        (("changes", *CLOUDS), "--noise", (0.005, 0.5), (0.0049, 0.501)),
        (("convert", "a.ply", "b.las"), "--thin", (0.001, 10), (0.0009, 10.1)),
        (("grasp", "a.ply"), "--segment", (0, 1000), (-1,)),
        (("campaign", "yard"), "--jobs", (1, 1000), (0, -1)),
        (("plugins", "test", "alignment", "gicp"), "--time-limit", (0, 1e6), (-0.1,)),
    ],
)
def test_a_number_is_taken_up_to_its_bounds(monkeypatch, capsys, words, option, taken, refused):
    asked = []
    command_of = verbs.command_of

    def noted(name, function):
        found = command_of(name, function)
        found.callback = lambda **given: asked.append(given)
        return found

    monkeypatch.setattr(verbs, "command_of", noted)
    monkeypatch.setattr(main, "command_of", noted)
    for number, value in enumerate(taken, 1):
        assert executive(monkeypatch, *words, option, value) == 0, capsys.readouterr().err
        assert len(asked) == number
    for value in refused:
        assert executive(monkeypatch, *words, option, value) == 2
        told = capsys.readouterr().err
        assert f"Invalid value for '{option}': Input should be " in told
    assert len(asked) == len(taken)
