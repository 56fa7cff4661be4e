"""Physics of the simulated world: contacts that do not creep, and their settings."""

import mujoco
from pydantic import Field

from executive.config import Newtons, Seconds, Settings


class PhysicsSettings(Settings):
    """How the world is integrated and how surfaces touch; the defaults hold a 2.7 t stone without
    creeping.
    """

    timestep_s: Seconds = Field(0.0025, ge=0.001, le=0.004, description="Integration step [s].")
    friction: float = Field(
        0.6, gt=0, le=2, description="Coulomb friction of steel, stone and ground."
    )
    torsional_friction_m: float = Field(
        0.08, ge=0, le=0.5, description="Size of a patch that resists turning [m]."
    )
    impratio: float = Field(
        100.0, ge=1, le=1000, description="Stiffness of friction over that of normal forces."
    )
    servo_rad_s: float = Field(
        25.0, gt=1, le=60, description="Natural frequency of the arm's position servos [rad/s]."
    )
    jaw_stiffness: float = Field(4.0, gt=0, le=20, description="Jaw speed per angle to go [1/s].")
    grip_force_n: Newtons = Field(
        35000.0, gt=0, description="Tip force before the first command [N]."
    )


def apply_physics(spec: mujoco.MjSpec, settings: PhysicsSettings) -> None:
    """Set the solver and the contacts of everything in a world that is complete but for its
    compilation.
    """
    option = spec.option
    option.timestep = settings.timestep_s
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.cone = (
        mujoco.mjtCone.mjCONE_ELLIPTIC
    )  # a pyramidal cone lets a held stone creep 1-8 mm/s
    option.impratio = settings.impratio
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE  # the sparse Cholesky of 4.0.0 is faulty
    option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
    for geom in spec.geoms:
        geom.condim = 4
        geom.friction = [settings.friction, settings.torsional_friction_m, 0.0]
        geom.solref = [0.01, 1.0]
        geom.solimp = [0.95, 0.99, 0.002, 0.5, 2.0]
    for tie in spec.equalities:
        tie.solref, tie.solimp = [0.01, 1.0], [0.99, 0.999, 0.001, 0.5, 2.0]
