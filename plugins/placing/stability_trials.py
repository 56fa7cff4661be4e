"""What a structure withstands in a contact engine: drift, tilt and a push.

All trials of one friction begin in one state: the structure at rest. It is found once and restored
for each of them.
"""

import mujoco
import numpy as np
from executive_plugins.physics.equilibrium import largest_load
from executive_plugins.physics.stone_world import WorldRules, world_of
from executive_plugins.physics.trial import TOUCHING_M, touches_of

from executive.arrays import Float
from executive.machine.gravity import GRAVITY_M_S2
from executive.messages.building import AsBuilt

_REST_S, _MOST_REST_S = 0.5, 2.0
_MOVED_M = 0.10  # a stone that moved this far has left its place
_COARSE_DEG, _FINE_DEG = 2.0, 1.0
# A tilt is held until all is at rest, or a stone has left its place: a tall stone topples slowly.
_LEAST_TILT_S, _MOST_TILT_S, _CHECK_S = 0.3, 3.0, 0.1
_STILL = 0.01  # [m/s] and [rad/s]
_PUSH_G, _PUSH_S, _AFTER_S = 0.2, 0.3, 2.0


class StabilityTrials:
    """A structure in a world of its own, tried again and again from where it rests."""

    def __init__(self, built: AsBuilt, rules: WorldRules) -> None:
        self._built = built
        self._rules = rules
        self._world = world_of(built, rules)
        self._world.settle(_REST_S, _MOST_REST_S)
        self._rest = self._state()
        self._places = self._now()

    def drift_m(self, duration_s: float) -> float:
        """Return how far any stone moves from the poses that were handed in [m]."""
        self._restore(self._rest)
        given = np.array([one.T_map_stone[:3, 3] for one in self._built.standing])
        self._step(duration_s - float(self._world.data.time))
        return float(np.linalg.norm(self._now() - given, axis=1).max())

    def tilt_deg(self, towards: Float, most_deg: float) -> float:
        """Return the tilt to the worse of two sides at which no stone has moved by 10 cm yet [deg].

        Steps of 2° until a stone moves; then the last state that stood is tilted by 1° alone.
        """
        return min(self._tilt_one_side(sign * towards, most_deg) for sign in (1.0, -1.0))

    def _tilt_one_side(self, towards: Float, most_deg: float) -> float:
        stood, state, step_deg = 0.0, self._rest, _COARSE_DEG
        while step_deg >= _FINE_DEG and stood < most_deg:
            self._restore(state)
            if self._stands_at(np.radians(stood + step_deg), towards):
                stood, state = stood + step_deg, self._state()
            else:
                step_deg /= 2.0
        return min(stood, most_deg)

    def _stands_at(self, angle_rad: float, towards: Float) -> bool:
        down = np.array([0.0, 0.0, -np.cos(angle_rad)])
        self._world.model.opt.gravity[:] = GRAVITY_M_S2 * (down + np.sin(angle_rad) * towards)
        for number in range(1, round(_MOST_TILT_S / _CHECK_S) + 1):
            self._step(_CHECK_S)
            if np.linalg.norm(self._now() - self._places, axis=1).max() > _MOVED_M:
                return False
            if number * _CHECK_S >= _LEAST_TILT_S and self._world.speed() < _STILL:
                return True
        return True

    def pushed_m(self, towards: Float) -> float:
        """Return how far a top stone moves by 0.2 g for 0.3 s in a direction [m]."""
        self._restore(self._rest)
        data, heights = self._world.data, self._places[:, 2]
        is_top = heights >= np.quantile(heights, 0.75)
        first = self._world.model.body("stone_0").id
        for number in np.flatnonzero(is_top):
            mass = self._built.standing[number].stone.mass_kg
            data.xfrc_applied[first + number, :3] = _PUSH_G * GRAVITY_M_S2 * mass * towards
        self._step(_PUSH_S)
        data.xfrc_applied[:] = 0.0
        self._step(_AFTER_S)
        return float(np.linalg.norm(self._now() - self._places, axis=1)[is_top].max())

    def load(self, towards: Float) -> float | None:
        """Return the horizontal load, over its weight, that the whole bears by the linear program
        at its contacts at rest; None if it does not even bear its weight.

        As in the check of a place, faces that are closer than the shapes are true count as
        touching: stones at rest sway by fractions of a millimetre, so that at any instant some of
        the points that bear them are open, and a wall that stood for 20 s had no balance.
        """
        self._restore(self._rest)
        masses = np.array([one.stone.mass_kg for one in self._built.standing])
        touches = touches_of(self._world, within_m=TOUCHING_M)
        found = [
            largest_load(touches, self._places, masses, self._rules.friction, sign * towards)
            for sign in (1.0, -1.0)
        ]
        known = [one for one in found if one is not None]
        return min(known) if len(known) == len(found) else None

    def _now(self) -> Float:
        return np.array([self._world.pose_of(number)[:3, 3] for number in self._world.free])

    def _step(self, duration_s: float) -> None:
        self._world.step(max(1, round(duration_s / self._rules.step_s)))

    def _state(self) -> Float:
        model, data = self._world.model, self._world.data
        state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION))
        mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
        return state

    def _restore(self, state: Float) -> None:
        model, data = self._world.model, self._world.data
        model.opt.gravity[:] = (0.0, 0.0, -GRAVITY_M_S2)
        mujoco.mj_setState(model, data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
