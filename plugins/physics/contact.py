"""Contact between rigid bodies in MuJoCo: one model for the simulated world and simulated lifts."""

import mujoco
from executive_plugins.physics.surface import ContactModel, Surface

# Dimensions of a contact: sliding and torsional friction, and rolling friction where there is any.
_CONDIM, _ROLLING_CONDIM = 4, 6
_DAMPING_RATIO = 1.0
_SOLIMP = (0.95, 0.99, 0.002, 0.5, 2.0)
# Stiffness [1/s²] and damping [1/s] of joints tied to one another, negative as MuJoCo wants them.
# Forces of constraints are computed without the implicit damping of actuators: where one of the two
# is held by it, as in simulated lifts, the tie has less than what is asked for. Hence 300 and not
# the critical 200. A tie four times softer lost more stones in the missions that had it.
_TIE_SOLREF = (-10000.0, -300.0)
_TIE_SOLIMP = (0.99, 0.999, 0.001, 0.5, 2.0)
_FREE = mujoco.mjtJoint.mjJNT_FREE
_WORLD = "world"  # MuJoCo's name of the body that everything stands on


def apply_contact(spec: mujoco.MjSpec, contact: ContactModel) -> None:
    """Set the integrator, the friction cone and the contacts of all geometries and ties of a world.

    Call it when the world is complete, before it is compiled. The elliptic cone with a high
    impratio is needed for grasping: with a pyramidal cone a held stone creeps by 1 to 8 mm/s.

    What lies in the world itself is soil, a free body without moving parts is a stone, and
    everything else is steel. MuJoCo takes all numbers of a contact from the geometry of higher
    `priority` (mj_contactParam), which makes them numbers of pairs.
    """
    option = spec.option
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = contact.impratio
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE  # MuJoCo 4.0.0: sparse Cholesky is faulty
    for geom in spec.geoms:
        geom.priority, surface = _surface(geom, contact)
        geom.condim = _ROLLING_CONDIM if surface.rolling_m > 0 else _CONDIM
        geom.friction = [surface.friction, surface.torsional_m, surface.rolling_m]
        geom.solref = [surface.time_constant_s, _DAMPING_RATIO]
        geom.solimp = list(_SOLIMP)
    for tie in spec.equalities:
        tie.solref, tie.solimp = list(_TIE_SOLREF), list(_TIE_SOLIMP)


def _surface(geom: mujoco.MjsGeom, contact: ContactModel) -> tuple[int, Surface]:
    """Return the priority of a geometry's material, and its surface."""
    body = geom.parent
    if body.name == _WORLD:
        return 1, contact.soil
    is_free = any(joint.type == _FREE for joint in body.joints)
    return (0, contact.stone) if is_free and not body.bodies else (2, contact.steel)
