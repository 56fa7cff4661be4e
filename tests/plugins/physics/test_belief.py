"""What rehearsals assume of contacts."""

import pytest
from executive_plugins.physics.belief import belief_of
from executive_plugins.physics.scenario import Scenario, contact_of
from executive_plugins.physics.surface import Surface, uniform

from executive.machine.machine import load_machine

GRIPPER = load_machine("m545").gripper


@pytest.mark.parametrize("scenario", ["nominal", "wet", "harsh"])
def test_a_belief_is_about_the_contacts_of_the_world_of_its_name(scenario: Scenario) -> None:
    belief, world = belief_of(scenario, GRIPPER), contact_of(scenario, GRIPPER)
    assert belief.middle == pytest.approx(world.steel.friction)
    believed = belief.contact(belief.middle)
    assert believed.steel.torsional_m == pytest.approx(world.steel.torsional_m)
    assert (believed.soil, believed.stone) == (world.soil, world.stone)


def test_the_moment_of_a_patch_is_in_proportion_to_the_friction() -> None:
    belief = belief_of("wet", GRIPPER)
    least, middle = (belief.contact(mu).steel for mu in (belief.least, belief.middle))
    assert least.torsional_m / middle.torsional_m == pytest.approx(belief.least / belief.middle)


def test_a_kind_belief_has_one_friction_for_all_and_less_torsion_than_the_kind_world() -> None:
    belief = belief_of("kind", GRIPPER)
    assert belief.contact(belief.least) == uniform(Surface(0.45, 0.05))
    assert belief.middle < contact_of("kind", GRIPPER).steel.friction


def test_a_range_of_friction_that_is_given_replaces_that_of_the_scenario() -> None:
    belief = belief_of("nominal", GRIPPER, (0.2, 0.3))
    assert belief.contact(belief.least).steel.friction == 0.2
    assert belief.contact(0.2).soil == contact_of("nominal", GRIPPER).soil


def test_stones_that_may_be_wet_or_dry_have_the_friction_of_both_and_the_soil_of_nominal() -> None:
    belief = belief_of("wet_to_dry", GRIPPER)
    wet, dry = (belief_of(scenario, GRIPPER).friction for scenario in ("wet", "nominal"))
    assert belief.friction == (wet[0], dry[1])
    assert belief.contact(0.3).soil == contact_of("nominal", GRIPPER).soil
