"""The shipped checks of a place: settling under noise in physics, and a convex program."""

from collections.abc import Sequence

import numpy as np
from executive_plugins.physics.equilibrium import least_load
from executive_plugins.physics.stone_world import WorldRules
from executive_plugins.physics.trial import Bounds, Outcome, Trial, apart, rest_of
from executive_plugins.placing.dry_stone.other_shapes import OtherShapes
from executive_plugins.placing.dry_stone.parts import Place, Stability
from executive_plugins.placing.dry_stone.releases import releases
from executive_plugins.placing.dry_stone.settings import CheckSettings

from executive.arrays import Bool, Float
from executive.interfaces.building import MayGoOn
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.solid_stone import SolidStone

_DIRECTIONS = 8  # of the horizontal load
_FAR_M, _FAR_RAD = 0.25, 0.45  # a stone that settles farther from its place is somewhere else
_RELEASE_M = 0.02
_TOUCH_M = 0.05  # boxes of two stones that may touch are at most so far apart


class Unchecked:
    """No check at all: the place is taken as it is."""

    def __init__(self, settings: CheckSettings) -> None:
        del settings

    def check(
        self, place: Place, built: AsBuilt, rng: np.random.Generator, may_go_on: MayGoOn
    ) -> Stability:
        """Return the place itself."""
        return Stability("", place.T_map_stone, 0.0, 0.0, {})


class TrialsOfStructure:
    """Trials of the places of one plan, each with the stones near it alone.

    Free to move are the stones that the new one can reach before it counts as somewhere else,
    whatever their height. What these may lean on is fixed, and stones farther off are left out: a
    trial of a place costs the same on a long wall as on a short one. The structure finds its rest
    once, and a world is built once for all releases at a place.
    """

    def __init__(self, rules: WorldRules) -> None:
        self._rules = rules
        self._built: AsBuilt | None = None
        self._rest: Sequence[Float] = ()
        self._boxes: Float = np.zeros((0, 2, 2))
        self._trials: dict[tuple[SolidStone, bytes], Trial] = {}
        self._still: dict[tuple[SolidStone, bytes], Trial] = {}

    def of(self, built: AsBuilt, place: Place) -> Trial:
        """Return the trial of a stone at a place of a structure."""
        is_near = self._reached(built, place)
        is_there = is_near | _within(self._boxes[is_near], self._boxes, _TOUCH_M)
        key = place.stone, np.stack([is_near, is_there]).tobytes()
        if key not in self._trials:
            there = np.flatnonzero(is_there).tolist()
            part = built.with_standing(*(built.standing[n] for n in there))
            rest, fixed = [self._rest[n] for n in there], [not is_near[n] for n in there]
            self._trials[key] = Trial(part, place.stone, self._rules, rest, fixed)
        return self._trials[key]

    def among_fixed(self, built: AsBuilt, place: Place) -> Trial | None:
        """Return the same trial with stones that hold still; None if none is near.

        It takes a tenth of the time of one in which they move.
        """
        is_near = self._reached(built, place)
        key = place.stone, is_near.tobytes()
        if not is_near.any():
            return None
        if key not in self._still:
            near = np.flatnonzero(is_near).tolist()
            part = built.with_standing(*(built.standing[n] for n in near))
            rest = [self._rest[n] for n in near]
            self._still[key] = Trial(part, place.stone, self._rules, rest, [True] * len(near))
        return self._still[key]

    def _reached(self, built: AsBuilt, place: Place) -> Bool:
        """Return which stones the new one can reach before it counts as somewhere else."""
        if built is not self._built:
            self._built, self._rest = built, rest_of(built, self._rules)
            self._boxes = _boxes(built, self._rest)
            self._trials.clear()
            self._still.clear()
        return self._near(StandingStone(place.stone, place.T_map_stone), _FAR_M)

    def in_other_shapes(
        self, built: AsBuilt, stone: SolidStone, settled: Outcome, settings: CheckSettings
    ) -> OtherShapes:
        """Return a settled stone and those that it may touch under noise, in their second shapes.

        `of` comes first: it finds where the structure rests.
        """
        place = StandingStone(stone, settled.T_map_settled)
        near = np.flatnonzero(self._near(place, settings.worst + _TOUCH_M)).tolist()
        part = built.with_standing(*(built.standing[n] for n in near))
        return OtherShapes(part, [self._rest[n] for n in near], stone, settings)

    def _near(self, one: StandingStone, distance_m: float) -> Bool:
        return _within(_box(one)[None], self._boxes, distance_m)


def _boxes(built: AsBuilt, rest: Sequence[Float]) -> Float:
    """Return the boxes from above of stones at rest, least and largest x and y, (N, 2, 2)."""
    stones = zip(built.standing, rest, strict=True)
    boxes = [_box(StandingStone(one.stone, T)) for one, T in stones]
    return np.array(boxes).reshape(-1, 2, 2)


def _box(one: StandingStone) -> Float:
    xy = one.vertices_map()[:, :2]
    return np.stack([xy.min(axis=0), xy.max(axis=0)])


def _within(these: Float, others: Float, distance_m: float) -> Bool:
    """Return which of the others are at most a distance away from any of these, from above."""
    gaps = np.maximum(
        these[:, None, 0] - others[None, :, 1], others[None, :, 0] - these[:, None, 1]
    )
    return np.asarray((gaps <= distance_m).all(axis=2).any(axis=0))


class Checks:
    """Nominal settling, then the balance of forces at rest, then settling under noise.

    Most places do not hold, and most of these not even among stones that hold still: that is tried
    first, for it takes a tenth of the time.
    """

    _has_equilibrium, _has_settling = True, True

    def __init__(self, settings: CheckSettings) -> None:
        self._settings = settings
        s = settings
        self._trials = TrialsOfStructure(WorldRules(s.step_s, s.friction, s.pieces))

    def check(
        self, place: Place, built: AsBuilt, rng: np.random.Generator, may_go_on: MayGoOn
    ) -> Stability:
        """Return where the stone comes to rest, or why it does not hold."""
        refusal = self._refusal_among_fixed(place, built) if self._has_settling else ""
        if refusal:
            return Stability(refusal, place.T_map_stone, 0.0, 0.0, {})
        trial = self._trials.of(built, place)
        nominal = trial.release(
            place.T_map_stone, _RELEASE_M, Bounds(place.T_map_stone, _FAR_M, _FAR_RAD)
        )
        refusal = self._refusal(nominal, place.T_map_stone, _FAR_M, _FAR_RAD)
        terms: dict[str, float] = {}
        if not refusal and self._has_equilibrium:
            load = self._load(trial, nominal.T_map_settled, place.stone.mass_kg)
            terms["bears_load"] = load if load is not None else 0.0
            if load is None or load < self._settings.load:
                refusal = "bears_no_load"
        if refusal or not self._has_settling:
            return Stability(refusal, nominal.T_map_settled, *self._apart(nominal), terms)
        others = self._trials.in_other_shapes(built, place.stone, nominal, self._settings)
        return self._under_noise((trial, others), nominal.T_map_settled, rng, may_go_on, terms)

    def _refusal_among_fixed(self, place: Place, built: AsBuilt) -> str:
        """Return why a stone does not even hold among stones that hold still; empty if it does."""
        trial = self._trials.among_fixed(built, place)
        if trial is None:
            return ""
        bounds = Bounds(place.T_map_stone, _FAR_M, _FAR_RAD)
        found = trial.release(place.T_map_stone, _RELEASE_M, bounds)
        refusal = self._refusal(found, place.T_map_stone, _FAR_M, _FAR_RAD)
        if refusal:
            return refusal
        others = self._trials.in_other_shapes(built, place.stone, found, self._settings)
        return "reseats" if others.moves(found.T_map_settled) > self._settings.reseated else ""

    def _under_noise(
        self,
        worlds: tuple[Trial, OtherShapes],
        T: Float,
        rng: np.random.Generator,
        may_go_on: MayGoOn,
        terms: dict[str, float],
    ) -> Stability:
        s, (trial, others), worst_m, worst_rad = self._settings, worlds, 0.0, 0.0
        terms["reseats_m"] = others.moves(T)
        refusal = "reseats" if terms["reseats_m"] > s.reseated else ""
        # The stone is let go where it is expected to rest: from there noise leads least far.
        for start in [] if refusal else releases(T, s.samples, s.noise, s.tilt_noise, rng):
            if not may_go_on():
                return Stability("out_of_time", T, worst_m, worst_rad, terms)
            tried = trial.release(start, _RELEASE_M, Bounds(T, s.worst, s.worst_tilt))
            far_m, far_rad = apart(T, tried.T_map_settled)
            worst_m, worst_rad = max(worst_m, far_m), max(worst_rad, far_rad)
            refusal = self._refusal(tried, T, s.worst, s.worst_tilt)
            if not refusal:
                moved_m = others.moves(tried.T_map_settled)
                terms["reseats_m"] = max(terms["reseats_m"], moved_m)
                refusal = "reseats" if moved_m > s.reseated else ""
            if refusal:
                refusal = f"{refusal}_under_noise"
                break
        return Stability(refusal, T, worst_m, worst_rad, terms)

    def _refusal(self, found: Outcome, T: Float, far_m: float, far_rad: float) -> str:
        distance_m, angle_rad = apart(T, found.T_map_settled)
        if distance_m > far_m:
            return "slides_away"
        if angle_rad > far_rad:
            return "topples"
        if not found.is_at_rest:
            return "comes_to_no_rest"
        return "moves_others" if found.moved_m > self._settings.moved else ""

    def _apart(self, found: Outcome) -> tuple[float, float]:
        return apart(found.T_map_release, found.T_map_settled)

    def _load(self, trial: Trial, T: Float, mass_kg: float) -> float | None:
        angles = 2 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
        around = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(_DIRECTIONS)])
        masses_kg, friction = np.array([mass_kg]), self._settings.friction
        return least_load(trial.touches(), T[None, :3, 3], masses_kg, friction, around)


class Equilibrium(Checks):
    """One nominal settling, and the balance of forces where it ends."""

    _has_settling = False


class Settling(Checks):
    """Settling alone, nominal and under noise."""

    _has_equilibrium = False
