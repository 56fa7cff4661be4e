"""Scenarios of physics: the same world with contacts from kind to harsh, each number with its
reason.

docs/simulator.md repeats the numbers for users. `kind` is the world in which all figures of this
project before the scenarios were drawn.
"""

import math
from typing import Literal

from executive_plugins.physics.surface import RIGID_S, ContactModel, Surface, round_patch, uniform

from executive.machine.gripper import Gripper

Scenario = Literal["kind", "nominal", "wet", "harsh"]

# One friction for all pairs, and a moment about the normal like that of a patch of 0.2 m radius,
# which no tooth has: the grip holds like a weld.
_KIND = uniform(Surface(friction=0.6, torsional_m=0.08))

# Steel on rock: 0.5 dry to 0.3 wet (the range of rock bolts, drill steel and chute linings in
# handbooks; grapple teeth are smooth by wear). `nominal` is the middle: damp, dusty.
_STEEL_DRY_TO_WET = {"nominal": 0.4, "wet": 0.3, "harsh": 0.3}
# Share of the tooth's half width that touches. On a rough stone the whole tooth bears at best; in
# `harsh` it bears on a corner.
_TOOTH_SHARE = {"nominal": 1.0, "wet": 1.0, "harsh": 0.5}
# Stone on soil: the tangent of the soil's friction angle, since the soil shears before the stone
# slides on it: 31° of medium gravelly sand, 26° of wet silty sand, 22° of wet clayey silt.
_SOIL_FRICTION = {"nominal": 0.6, "wet": 0.49, "harsh": 0.4}
# How deep the lowest point of a stone sinks into firm, wet and soft soil [m]; a guess.
_SINKAGE_M = {"nominal": 0.01, "wet": 0.02, "harsh": 0.03}
_CURVATURE_M = 0.5  # radius of curvature of a stone of 0.5 to 1 m³, for the dent that it makes [m]
# Before a stone rolls, only the half of its dent ahead bears. The centroid of half a disc of
# radius a is at 4a/(3π) from the centre, and so is the resultant of even pressure.
_HALF_DISC = 4.0 / (3.0 * math.pi)
# Compliance of the ground: a stone of 2 t on 0.3 m² of soil with a modulus of subgrade reaction
# of 75, 20 and 10 MN/m³ (dense gravel, wet sand, soft silt) oscillates with ω² = k/m of 11,000,
# 3,000 and 1,500 1/s²; the time constant of a critically damped contact is 1/ω.
_SOIL_TIME_S = {"nominal": RIGID_S, "wet": 0.018, "harsh": 0.026}
# Stone on stone: 0.6 to 0.7 for rough, unpolished faces (Byerlee 1978: 0.85 below 200 MPa for
# ground surfaces that interlock; Barton's residual angles of 25 to 35° for weathered joints).
_STONE_FRICTION = {"nominal": 0.65, "wet": 0.6, "harsh": 0.5}
_ASPERITY_M = 0.03  # radius of the patch of contact of two rough faces [m]
_ASPERITY_ROLLING_M = 0.005  # two asperities some 10 mm apart bear, not one point [m]


def contact_of(scenario: Scenario, gripper: Gripper) -> ContactModel:
    """Return the contacts of a scenario for a machine with a gripper.

    The patch of steel on stone is that of the gripper's narrowest tooth.
    """
    if scenario == "kind":
        return _KIND
    patch_m = _TOOTH_SHARE[scenario] * gripper.tooth_half_width_m
    dent_m = math.sqrt(2.0 * _CURVATURE_M * _SINKAGE_M[scenario])  # of a sphere, to first order
    return ContactModel(
        steel=round_patch(_STEEL_DRY_TO_WET[scenario], patch_m),
        soil=round_patch(
            _SOIL_FRICTION[scenario], dent_m, _HALF_DISC * dent_m, _SOIL_TIME_S[scenario]
        ),
        stone=round_patch(_STONE_FRICTION[scenario], _ASPERITY_M, _ASPERITY_ROLLING_M),
    )
