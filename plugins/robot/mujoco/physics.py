"""Physics of the simulated world: its integration, its contacts, and the gains of its drives."""

import mujoco
from executive_plugins.physics.contact import apply_contact
from executive_plugins.physics.surface import ContactModel
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings


def apply_physics(spec: mujoco.MjSpec, settings: PhysicsSettings, contact: ContactModel) -> None:
    """Set the solver and all contacts of a complete world, before it is compiled."""
    spec.option.timestep = settings.timestep_s
    spec.option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
    apply_contact(spec, settings.replaced(contact))
