"""Entry points of packages that are wrong: each is told with its name and what it should be."""

from collections.abc import Callable, Mapping
from importlib.metadata import EntryPoint

import pytest

from executive import registry
from executive.errors import UnknownPluginError
from executive.interfaces.motion import MotionPlanner
from executive.registry import BrokenPluginError

Announce = Callable[[str, str, str], None]


@pytest.fixture
def announce(monkeypatch: pytest.MonkeyPatch) -> Announce:
    """Let a group have an entry point more: group, name, target."""
    real, more = registry._entry_points, dict[str, dict[str, EntryPoint]]()

    def points(group: str) -> Mapping[str, EntryPoint]:
        return {**real(group), **more.get(group, {})}

    def add(group: str, name: str, target: str) -> None:
        more.setdefault(group, {})[name] = EntryPoint(name, target, f"executive.{group}.v1")

    monkeypatch.setattr(registry, "_entry_points", points)
    return add


@pytest.mark.parametrize(
    ("target", "told"),
    [
        ("math:pi", r"motion plugin 'mine' \(3\.14\d*\) is no class"),
        ("math:tau_of", r"motion plugin 'mine' \(math:tau_of\) cannot be loaded: .*tau_of"),
        ("no_such_module:Plugin", r"\(no_such_module:Plugin\) cannot be loaded: No module named"),
    ],
)
def test_a_plugin_that_cannot_be_loaded_is_told(announce: Announce, target: str, told: str) -> None:
    announce("motion", "mine", target)
    with pytest.raises(BrokenPluginError, match=told):
        registry.load("motion", "mine")


@pytest.mark.parametrize(
    ("target", "told"),
    [
        ("math:pi", r"interface plugin 'juggling' .* is no class"),
        ("fractions:Fraction", "capability 'juggling': Fraction does not derive from Plugin"),
        (
            "executive.interfaces.motion:MotionPlanner",
            "capability 'juggling': MotionPlanner.capability is 'motion'; the entry point and the",
        ),
    ],
)
def test_an_interface_that_is_none_is_told(announce: Announce, target: str, told: str) -> None:
    announce(registry.INTERFACES, "juggling", target)
    assert "juggling" in registry.capabilities()
    with pytest.raises(BrokenPluginError, match=told.replace("interface plugin", "plugin")):
        registry.interface("juggling")


def test_a_verb_is_a_function(announce: Announce) -> None:
    announce(registry.VERBS, "mine", "math:pi")
    announce(registry.VERBS, "yours", "textwrap:dedent")
    with pytest.raises(BrokenPluginError, match=r"'mine' \(3\.14\d*\) is no function"):
        registry.load_verb("mine")
    assert registry.load_verb("yours")("  a") == "a"


def test_settings_that_are_announced_apart_are_a_class_of_settings(announce: Announce) -> None:
    announce("motion", "mine", "no_such_module:Plugin")
    announce(registry.SETTINGS, "motion.mine", "fractions:Fraction")
    told = "motion plugin 'mine': fractions:Fraction is no class of PluginSettings"
    with pytest.raises(BrokenPluginError, match=told):
        registry.declared("motion", "mine")


def test_what_is_not_there_is_unknown_and_what_is_right_is_loaded() -> None:
    assert registry.interface("motion") is MotionPlanner
    with pytest.raises(UnknownPluginError):
        registry.interface("juggling")
    with pytest.raises(UnknownPluginError):
        registry.declared("motion", "no_such")
