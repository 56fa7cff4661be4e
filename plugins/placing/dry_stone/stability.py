"""The shipped checks of a place: settling under noise in physics, and a convex program."""

from collections.abc import Sequence

import numpy as np
from executive_plugins.physics.equilibrium import least_load
from executive_plugins.physics.trial import Bounds, Outcome, Trial, apart, rest_of
from executive_plugins.placing.dry_stone.fixed_neighbours import FixedNeighbours, rules_of
from executive_plugins.placing.dry_stone.other_shapes import OtherShapes
from executive_plugins.placing.dry_stone.parts import Place, Stability
from executive_plugins.placing.dry_stone.releases import releases
from executive_plugins.placing.dry_stone.settings import CheckSettings

from executive.arrays import Bool, Float
from executive.interfaces.building import MayGoOn
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.solid_stone import SolidStone

_DIRECTIONS = 8  # of the horizontal load
_FAR_M, FAR_RAD = 0.25, 0.45  # a stone that settles farther from its place is somewhere else
_RELEASE_M = 0.02
_CELL_M = 1.0  # of places that share a world: about a stone, so that it holds few others
_TURNS = 2**32  # seeds of the releases at one place
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

    def __init__(self, settings: CheckSettings) -> None:
        self._settings = settings
        self._rules = rules_of(settings)
        self._built: AsBuilt | None = None
        self._rest: Sequence[Float] = ()
        self._boxes: Float = np.zeros((0, 2, 2))
        self._trials: dict[tuple[SolidStone, bytes], Trial] = {}
        self._still: dict[tuple[SolidStone, bytes], FixedNeighbours] = {}

    def of(self, built: AsBuilt, place: Place) -> Trial:
        """Return the trial of a stone at a place of a structure."""
        self._begin(built)
        is_near = self._near(StandingStone(place.stone, place.T_map_stone), _FAR_M)
        is_there = is_near | _within(self._boxes[is_near], self._boxes, _TOUCH_M)
        key = place.stone, np.stack([is_near, is_there]).tobytes()
        if key not in self._trials:
            there = np.flatnonzero(is_there).tolist()
            part = built.with_standing(*(built.standing[n] for n in there))
            rest, fixed = [self._rest[n] for n in there], [not is_near[n] for n in there]
            self._trials[key] = Trial(part, place.stone, self._rules, rest, fixed)
        return self._trials[key]

    def among_fixed(self, built: AsBuilt, place: Place) -> FixedNeighbours:
        """Return the stone among stones that hold still, in both models of their shapes.

        A release takes a tenth of the time of one in which they move. One world serves all places
        of a cell of the ground: it holds what the stone can reach from anywhere in the cell.
        """
        self._begin(built)
        cell = np.rint(place.T_map_stone[:2, 3] / _CELL_M)
        key = place.stone, cell.tobytes()
        if key not in self._still:
            span_m = float(np.linalg.norm(place.stone.vertices, axis=1).max())
            reach_m = span_m + _CELL_M / 2 + _FAR_M + self._settings.worst + _TOUCH_M
            box = np.stack([cell * _CELL_M - reach_m, cell * _CELL_M + reach_m])
            near = np.flatnonzero(_within(box[None], self._boxes, 0.0)).tolist()
            part = built.with_standing(*(built.standing[n] for n in near))
            rest = [self._rest[n] for n in near]
            self._still[key] = FixedNeighbours(part, rest, place.stone, self._settings)
        return self._still[key]

    def _begin(self, built: AsBuilt) -> None:
        """Find where a structure rests, unless it is the one that was asked for last."""
        if built is not self._built:
            self._built, self._rest = built, rest_of(built, self._rules)
            self._boxes = _boxes(built, self._rest)
            self._trials.clear()
            self._still.clear()

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
        self._trials = TrialsOfStructure(settings)

    def check(
        self, place: Place, built: AsBuilt, rng: np.random.Generator, may_go_on: MayGoOn
    ) -> Stability:
        """Return where the stone comes to rest, or why it does not hold."""
        neighbours, turn = None, int(rng.integers(_TURNS))
        if self._has_settling:
            neighbours = self._trials.among_fixed(built, place)
            found = self._among_fixed(neighbours, place, turn, may_go_on)
            if found.refusal:
                return found
        trial = self._trials.of(built, place)
        nominal = trial.release(
            place.T_map_stone, _RELEASE_M, Bounds(place.T_map_stone, _FAR_M, FAR_RAD)
        )
        refusal = self._settles_off(nominal, place)
        terms: dict[str, float] = {}
        if not refusal and self._has_equilibrium:
            load = self._load(trial, nominal.T_map_settled, place.stone.mass_kg)
            terms["bears_load"] = load if load is not None else 0.0
            if load is None or load < self._settings.load:
                refusal = "bears_no_load"
        if refusal or neighbours is None:
            return Stability(refusal, nominal.T_map_settled, *self._apart(nominal), terms)
        worlds = trial, neighbours.others
        return self._under_noise(worlds, nominal.T_map_settled, turn, may_go_on, terms)

    def _among_fixed(
        self, neighbours: FixedNeighbours, place: Place, turn: int, may_go_on: MayGoOn
    ) -> Stability:
        """Return why a stone does not even hold among stones that hold still, under noise too.

        The releases are those that come later among free stones.
        """
        T = place.T_map_stone
        if neighbours.is_alone:
            return Stability("", T, 0.0, 0.0, {})
        found = neighbours.trial.release(T, _RELEASE_M, Bounds(T, _FAR_M, FAR_RAD))
        if refusal := self._settles_off(found, place):
            return Stability(refusal, T, 0.0, 0.0, {})
        worlds = neighbours.trial, neighbours.others
        return self._under_noise(worlds, found.T_map_settled, turn, may_go_on, {})

    def _under_noise(
        self,
        worlds: tuple[Trial, OtherShapes],
        T: Float,
        turn: int,
        may_go_on: MayGoOn,
        terms: dict[str, float],
    ) -> Stability:
        s, (trial, others), worst_m, worst_rad = self._settings, worlds, 0.0, 0.0
        rng = np.random.default_rng(turn)
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

    def _settles_off(self, found: Outcome, place: Place) -> str:
        """Return why a stone that is let go at its place settles elsewhere, if it does."""
        refusal = self._refusal(found, place.T_map_stone, _FAR_M, FAR_RAD)
        if refusal or self._settings.most_tilt is None:
            return refusal
        turned = found.T_map_settled[:3, :3] @ place.T_map_stone[:3, :3].T
        tilt_rad = float(np.arccos(np.clip(turned[2, 2], -1.0, 1.0)))
        return "tilts" if tilt_rad > self._settings.most_tilt else ""

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
