"""The shipped trial site: rigid stones in MuJoCo, all of them free to move."""

import numpy as np
from executive_plugins.physics.stone_world import WorldRules
from executive_plugins.physics.trial import Trial, disturbed

from executive.arrays import Float
from executive.interfaces.trial_site import Settled, TrialSite
from executive.messages.building import AsBuilt
from executive.messages.solid_stone import SolidStone

# Finer steps and shapes than the planner's check has, and another friction.
_RULES = WorldRules(step_s=0.004, friction=0.65, pieces=16)
_RELEASE_M = 0.02


class RigidStones(TrialSite):
    """Stones of 16 convex pieces at friction 0.65."""

    def place(
        self,
        built: AsBuilt,
        stone: SolidStone,
        T_map_stone: Float,
        noise: tuple[float, float],
        rng: np.random.Generator,
    ) -> Settled:
        """Lower a stone until it touches, let it go from 2 cm above, and observe."""
        trial = Trial(built, stone, _RULES)
        outcome = trial.release(disturbed(T_map_stone, *noise, rng), _RELEASE_M)
        return Settled(tuple(trial.poses()), outcome.moved_m, outcome.is_at_rest)
