"""Plugins are made after those that they need, and closed in the reverse order."""

import logging
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.mujoco.settings import MujocoSettings

from executive import registry
from executive.config import NoSettings
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.interfaces.robot import RobotSettings
from executive.mission import assembly
from executive.mission.assembly import (
    Assembly,
    assemble,
    each_plugin,
    needed_for,
    seeded,
    selected_plugins,
)
from executive.tree.selection import Selection


class Made(Plugin):
    """A plugin that keeps what it was given, and may fail when it is made."""

    def __init__(self, settings, **given):
        self.given = given


def plugin(name, *needs, fails=""):
    """Return a class of plugins that need others."""

    def made(self, settings, **given):
        if fails:
            raise ValueError(fails)
        self.given = given

    return type(name, (Made,), {"__init__": made, "needs": needs})


@pytest.fixture
def installed(monkeypatch):
    """Return what installs classes of plugins, by capability and name, in place of the shipped."""

    def install(**classes):
        load = registry.load

        def loaded(capability, name):
            return classes[capability][name] if capability in classes else load(capability, name)

        monkeypatch.setattr(registry, "load", loaded)
        monkeypatch.setattr(registry, "require_extras", lambda capability, name: None)
        monkeypatch.setattr(registry, "dependencies_of", lambda kind: kind.needs)
        return {
            capability: tuple(Selection(name, NoSettings()) for name in named)
            for capability, named in classes.items()
        }

    return install


def test_what_a_plugin_needs_is_made_before_it_and_given_to_it(installed):
    selections = installed(
        mapping={"map": plugin("Map", "alignment", "machine")},
        alignment={"fit": plugin("Fit", "rng")},
        estimation={"guess": plugin("Guess", "mapping")},
    )
    made = assemble(selections, "m545", 3)
    names = [type(one).__name__ for one in made.order]
    assert names.index("Fit") < names.index("Map") < names.index("Guess")
    fit, found, guess = (made.plugins[name] for name in ("alignment", "mapping", "estimation"))
    assert found.given == {"alignment": fit, "machine": made.machine}
    assert guess.given == {"mapping": found}
    expected = seeded(3, "alignment/fit", 0).random(4)
    np.testing.assert_array_equal(fit.given["rng"].random(4), expected)
    assert len(made.order) == 3


def test_plugins_of_a_plural_capability_are_given_together(installed):
    monitors = {"slip": plugin("Slip"), "drop": plugin("Drop")}
    made = assemble(installed(monitoring=monitors), "m545", 1)
    together = made.plugins["monitoring"]
    assert [type(one).__name__ for one in together] == ["Slip", "Drop"]
    assert list(each_plugin(made.plugins)) == [("monitoring", one) for one in together]


def test_a_circle_of_needs_is_told_with_its_way(installed):
    selections = installed(
        mapping={"map": plugin("Map", "alignment")}, alignment={"fit": plugin("Fit", "mapping")}
    )
    with pytest.raises(ConfigError, match="plugins need each other in a circle: ") as caught:
        assemble(selections, "m545", 1)
    way = str(caught.value).rpartition(": ")[2].split(" → ")
    assert way[0] == way[-1]
    assert {*way} == {"mapping", "alignment"}
    assert len(way) == 3


def test_a_need_that_is_not_selected_is_told(installed):
    selections = installed(mapping={"map": plugin("Map", "alignment")}, alignment={})
    told = "the mapping plugin needs a alignment plugin, and the mission selects none"
    with pytest.raises(ConfigError, match=told):
        assemble(selections, "m545", 1)


def test_an_error_while_a_plugin_is_made_names_it(installed):
    selections = installed(mapping={"map": plugin("Map", fails="no grid")})
    with pytest.raises(ValueError, match="no grid") as caught:
        assemble(selections, "m545", 1)
    assert caught.value.__notes__ == ["while the mapping plugin 'map' was made"]


def test_the_names_of_selected_plugins_are_those_of_the_registry(monkeypatch):
    one, other = plugin("One")(NoSettings()), plugin("Other")(NoSettings())
    monkeypatch.setattr(
        registry, "name_of", lambda capability, kind: f"{capability}/{kind.__name__}"
    )
    found = list(selected_plugins({"mapping": one, "placing.row": other}))
    assert found == [("mapping", "mapping/One", one), ("placing.row", "placing/Other", other)]


def test_a_copy_of_a_plugin_needs_what_that_needs_and_so_on(installed):
    selections = installed(
        robot={"sim": plugin("Sim")},
        alignment={"fit": plugin("Fit", "rng")},
        mapping={"map": plugin("Map", "alignment", "machine")},
        estimation={"guess": plugin("Guess", "mapping")},
    )
    assert set(needed_for(selections, "estimation")) == {"estimation", "mapping", "alignment"}
    assert needed_for(selections, "robot") == {"robot": selections["robot"]}


@pytest.mark.parametrize(
    ("may_tip", "support_n_m", "expected"),
    [(True, None, None), (True, 3e6, 3e6), (False, 3e6, None)],
)
def test_a_machine_may_tip_and_lean_where_its_robot_says_so(
    monkeypatch, may_tip, support_n_m, expected
):
    monkeypatch.setattr(assembly, "RobotSettings", SimpleNamespace)
    settings = SimpleNamespace(may_tip=may_tip, support_n_m=support_n_m, legs_s=0, ground="soil")
    stance = assembly.machine_of({"robot": (SimpleNamespace(settings=settings),)}, "m545").stance
    assert (stance.is_free, stance.support_n_m) == (may_tip, expected)


@pytest.mark.parametrize("base", ["on_legs", "on_wheels", "welded"])
def test_a_machine_on_legs_takes_time_to_raise_them_before_it_drives(base):
    settings = MujocoSettings(base=base)
    machine = assembly.machine_of({"robot": (SimpleNamespace(settings=settings),)}, "m545")
    assert machine.driving.legs_s == (settings.legs.longest_s if base == "on_legs" else 0.0)


@pytest.mark.parametrize(("ground", "digs_m"), [("soil", 0.13), ("rock", 0.0)])
def test_the_jaws_of_a_machine_go_into_the_ground_unless_it_is_rock(ground, digs_m):
    chosen = SimpleNamespace(settings=RobotSettings(ground=ground))
    machine = assembly.machine_of({"robot": (chosen,)}, "m545")
    assert machine.gripper.digs_m == digs_m
    assert not machine.stance.is_free


class Closing(Plugin):
    """A plugin that tells when it is closed, and may fail then."""

    def __init__(self, name, closed, fails=False):
        self._name, self._closed, self._fails = name, closed, fails

    def start(self):
        self._closed.append(f"start {self._name}")

    def close(self):
        self._closed.append(self._name)
        if self._fails:
            raise RuntimeError(self._name)


def test_all_plugins_are_closed_in_reverse_order_whatever_fails(caplog):
    closed = []
    order = tuple(Closing(name, closed, name in "bc") for name in "abcd")
    with caplog.at_level(logging.ERROR), pytest.raises(RuntimeError, match="c"):
        Assembly(None, {}, order).close()
    assert closed == ["d", "c", "b", "a"]
    (record,) = caplog.records
    assert str(record.exc_info[1]) == "b"
