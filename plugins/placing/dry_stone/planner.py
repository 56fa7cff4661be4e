"""Places found stones on one another: height maps propose, a score ranks, checks decide."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from executive_plugins.placing.dry_stone.check_order import CheckOrder
from executive_plugins.placing.dry_stone.drops import compile_drops
from executive_plugins.placing.dry_stone.failed_places import FailedPlaces
from executive_plugins.placing.dry_stone.footing import Noise
from executive_plugins.placing.dry_stone.height_maps import HeightMaps
from executive_plugins.placing.dry_stone.parts import (
    Generator,
    Place,
    Places,
    Scorer,
    Stability,
    StabilityCheck,
    TellsFooting,
    TiltsToRest,
    part_of,
)
from executive_plugins.placing.dry_stone.rasters import WallTop
from executive_plugins.placing.dry_stone.refusals import Refusals
from executive_plugins.placing.dry_stone.rolling import STEPS_RAD, compile_rolling
from executive_plugins.placing.dry_stone.search import Search, key_of, until
from executive_plugins.placing.dry_stone.settings import DryStoneSettings
from executive_plugins.placing.dry_stone.spread import spread
from executive_plugins.placing.dry_stone.stability import (
    FAR_RAD,
    Checks,
    Equilibrium,
    Settling,
    Unchecked,
)
from executive_plugins.placing.dry_stone.weighted import Weighted

from executive.arrays import Float
from executive.config import Settings
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.interfaces.building import MayGoOn, StructurePlanner
from executive.messages.building import AsBuilt, BuildPlan, BuildTarget, NoTarget
from executive.messages.solid_stone import SolidStone

_GENERATORS: Mapping[str, Any] = {"height_maps": HeightMaps}
_SCORERS: Mapping[str, Any] = {"weighted": Weighted}
_CHECKS: Mapping[str, Any] = {
    "both": Checks,
    "equilibrium": Equilibrium,
    "settling": Settling,
    "none": Unchecked,
}
_DOWN = np.array([0.0, 0.0, -1.0])
_APART_M = 0.25  # of two places of one stone that are worth a check each
_ARM_M = 0.5  # half a stone: a turn moves its ends by its angle times this


class DryStone(StructurePlanner):
    """Propose the next stone by what it would rest on (after Furrer 2017, Johns 2020)."""

    Settings: ClassVar[type[Settings]] = DryStoneSettings
    latency_s: ClassVar[dict[str, float]] = {"propose": 8.0}  # median 4 to 7 s, p95 9 to 16 s
    limit_s: ClassVar[dict[str, float]] = {"propose": 120.0}
    is_stateless: ClassVar[bool] = True

    def __init__(self, settings: DryStoneSettings) -> None:
        s = self._settings = settings
        parts = s.generator, s.scorer, s.check
        self._generator: Generator = part_of(parts[0].part, "generator", _GENERATORS, parts[0])
        more = {"turns": parts[0].turns * parts[0].finer, "supported": False}
        finer = parts[0].model_copy(update=more)
        self._finer: Generator = part_of(parts[0].part, "generator", _GENERATORS, finer)
        self._scorer: Scorer = part_of(parts[1].part, "scorer", _SCORERS, parts[1])
        self._noise = Noise(parts[2])
        # Told as exactly as a stone rolls in its last step; and as maps tell the place of its rim.
        self._most_rad = (parts[2].most_tilt or FAR_RAD) + STEPS_RAD[-1]
        self._most_doubted_rad = self._most_rad + parts[0].cell / 2 / _ARM_M
        self._check: StabilityCheck = part_of(parts[2].part, "check", _CHECKS, parts[2])

    def start(self) -> None:
        """Compile the inner loops, so that no search has to wait for them."""
        compile_drops()
        compile_rolling()

    def propose(
        self,
        built: AsBuilt,
        inventory: Sequence[SolidStone],
        rng: np.random.Generator,
        may_go_on: MayGoOn = lambda: True,
    ) -> BuildPlan:
        """Return the best stone and place that every check holds, within `may_go_on`."""
        _check_names(inventory)
        if (share := self._share_done(built)) >= self._settings.covered:
            return BuildPlan((), "complete", {}, f"{share:.0%} of it is up to its height")
        refused = Refusals()
        usable = self._usable(inventory, refused)
        if reason := refused.why_none(len(inventory), len(usable)):
            return refused.without_target(reason, self._detail(reason))
        again = FailedPlaces(built, self._settings)
        may_go_on = until(self._settings.budget, may_go_on)
        limit = self._most_rad
        search = Search(self._generator, built, usable, rng, may_go_on, refused, limit, again)
        stones = self._tried_first(usable, rng)
        targets: list[BuildTarget] = []
        for generator, most_rad in self._rounds():
            search.go_on_with(generator, most_rad)
            targets = self._first(stones, search)
            if targets or not may_go_on():
                break
        if not targets and not may_go_on():
            refused.total["out_of_time"] += 1
        return refused.plan(targets, len(usable))

    def _rounds(self) -> list[tuple[Generator, float]]:
        """Return by whom places are proposed, and the tilt beyond which they are left out [rad].

        Too few turns look like no room, and so does a height map that tells a stone too tilted.
        """
        rounds: list[tuple[Generator, float]] = [(self._generator, self._most_rad)]
        if self._settings.generator.finer > 1:
            rounds.append((self._finer, self._most_doubted_rad))
        return rounds

    def _first(self, stones: Sequence[SolidStone], search: Search) -> list[BuildTarget]:
        """Return the targets of the first lot of stones that has one."""
        targets: list[BuildTarget] = []
        count = self._settings.generator.stones
        search.refused.forget("no_place")  # counted anew
        for first in range(0, len(stones), count):
            targets = self._held(self._ranked(stones[first : first + count], search), search)
            if targets or not search.may_go_on():
                break
        return targets

    def _share_done(self, built: AsBuilt) -> float:
        """Return which share of the structure is up to its height."""
        wall = WallTop(built, self._settings.generator.cell)
        return wall.share_up_to(built.structure.height_m - self._settings.level)

    def _held(self, ranked: Sequence[Place], search: Search) -> list[BuildTarget]:
        """Return the first places that the check holds, of those that were not checked yet."""
        targets: list[BuildTarget] = []
        s = self._settings.check
        order, spent = CheckOrder(search.unchecked(ranked), search.failed, s.doubt), 0.0
        for place in order:
            is_enough = spent >= s.tries or len(targets) >= self._settings.targets
            if is_enough or not search.may_go_on():
                break
            found = self._check.check(place, search.built, search.rng, search.may_go_on)
            # A stone that tilts is let go once, and not under noise as well.
            spent += 1 / (1 + s.samples) if found.refusal == "tilts" else 1
            search.checked.add(key_of(place))
            if found.refusal:
                search.refused.add(place.stone.name, found.refusal)
                search.failed.append(place.T_map_stone[:2, 3])
                order.fail_at(search.failed[-1])
            else:
                targets.append(self._target(place, found))
        return targets

    def _usable(self, inventory: Sequence[SolidStone], refused: Refusals) -> list[SolidStone]:
        usable = []
        for stone in inventory:
            longest, _, thinnest = stone.extents_m
            # What jaws hold already was chosen, and lifted, whatever it has turned out to weigh.
            if stone.mass_kg > self._settings.max_mass and not stone.jaws:
                refused.add(stone.name, "too_heavy")
            elif longest > self._settings.slenderest * thinnest:
                refused.add(stone.name, "needle_or_slab")
            else:
                usable.append(stone)
        return usable

    def _tried_first(
        self, usable: Sequence[SolidStone], rng: np.random.Generator
    ) -> list[SolidStone]:
        """Return all stones in the order of the search: half of the first lot are the largest."""
        order = rng.permutation(len(usable))
        if self._settings.fills == "largest":
            by_size = np.argsort([-stone.volume_m3 for stone in usable], kind="stable")
            first = by_size[: (self._settings.generator.stones + 1) // 2]
            order = np.concatenate([first, order[~np.isin(order, first)]])
        return [usable[n] for n in order]

    def _ranked(self, stones: Sequence[SolidStone], search: Search) -> list[Place]:
        """Return the best places of each stone, best first."""
        self._find(stones, search)
        known = [search.found[one.name] for one in stones if one.name in search.found]
        for one in stones:
            if one.name in search.found and not search.found[one.name]:
                search.refused.add(one.name, "no_place")
        best = sorted((one for places in known for one in places), key=lambda one: -one.score)
        if not self._settings.generator.rested:
            return best
        firm: list[Place] = []
        for place in best[: self._settings.generator.rested]:
            if not search.may_go_on():
                break
            key = key_of(place)
            if key not in search.rested:
                search.rested[key] = self._firm(place, search)
            firm += search.rested[key]
        return sorted(firm, key=lambda one: -one.score)

    def _find(self, stones: Sequence[SolidStone], search: Search) -> None:
        """Go through all places of those stones that were not gone through yet."""
        new = [one for one in stones if one.name not in search.found]
        found = search.generator.places(search.built, new, search.rng, search.may_go_on)
        for stone, places in zip(new, found, strict=False):  # fewer if the time is over
            search.found[stone.name] = self._best(places, self._settings.generator.kept, search)

    def _firm(self, place: Place, search: Search) -> list[Place]:
        """Return a place as its stone rests there, ranked by its chance to hold; none without."""
        generator, rests = search.generator, [place]
        if self._settings.generator.tilts and isinstance(generator, TiltsToRest):
            places = generator.at_rest(place, search.built, search.usable)
            rests = [] if places is None else self._best([places], 1, search)
        if isinstance(generator, TellsFooting):
            rests = [firm for one in rests if (firm := self._risked(one, generator, search))]
        if not rests:
            search.refused.add(place.stone.name, "tilts_away")
        return rests

    def _risked(self, place: Place, generator: TellsFooting, search: Search) -> Place | None:
        """Return a place less what its checks will cost until one like it holds (Weitzman 1979)."""
        footing = generator.footing(place, search.built, self._noise, search.most_rad)
        if footing.tilt_rad > search.most_rad:
            return None
        if self._settings.check.is_free:
            return place
        risk = -self._settings.check.cost / footing.chance
        terms = {**place.terms, "risk": risk}
        return Place(place.stone, place.T_map_stone, place.score + risk, terms)

    def _best(self, found: Sequence[Places], kept: int, search: Search) -> list[Place]:
        """Return the best places of one stone that are apart, best first."""
        if not found:
            return []
        found, terms = self._scored(found, search)
        totals = [np.sum([np.asarray(t) for t in one.values()], axis=0) for one in terms]
        first = [np.argsort(-total, kind="stable")[: 4 * kept] for total in totals]
        score = np.concatenate([total[n] for total, n in zip(totals, first, strict=True)])
        at = np.vstack([one.origins_map[n] for one, n in zip(found, first, strict=True)])
        turned = [np.tile(one.R.ravel(), (len(n), 1)) for one, n in zip(found, first, strict=True)]
        points = np.hstack([at, _ARM_M / np.sqrt(2) * np.vstack(turned)])
        rows = [(number, int(n)) for number, chosen in enumerate(first) for n in chosen]
        order = np.argsort(-score, kind="stable")
        best: list[Place] = []
        for row in order[spread(np.ascontiguousarray(points[order], np.float64), kept, _APART_M)]:
            number, n = rows[row]
            values = {name: float(term[n]) for name, term in terms[number].items()}
            T = pose(found[number].R, at[row])
            best.append(Place(found[number].stone, T, float(score[row]), values))
        return best

    def _scored(
        self, found: Sequence[Places], search: Search
    ) -> tuple[list[Places], list[Mapping[str, Float]]]:
        """Return the places that are left where releases have failed, and all terms of theirs."""
        left: list[Places] = []
        terms: list[Mapping[str, Float]] = []
        for places in found:
            kept, term = search.again.left(places)
            if fell := len(places.origins_map) - len(kept.origins_map):
                search.refused.add(places.stone.name, "fell_there", fell)
            left.append(kept)
            terms.append({**self._scorer.score(kept, search.built, search.usable), **term})
        return left, terms

    def _target(self, place: Place, found: Stability) -> BuildTarget:
        lift = np.array([0.0, 0.0, self._settings.release_height])
        settled = found.T_map_settled
        return BuildTarget(
            place.stone.name,
            pose(settled[:3, :3], settled[:3, 3] + lift),
            settled,
            _DOWN.copy(),
            self._settings.release_height,
            found.worst_m,
            found.worst_rad,
            place.score,
            {**place.terms, **found.terms},
        )

    def _detail(self, reason: NoTarget) -> str:
        if reason == "all_too_heavy":
            return f"every stone is heavier than building.max_mass, {self._settings.max_mass:g} kg"
        if reason == "all_unsuitable":
            return "every stone is too heavy, or a needle or slab by building.slenderest"
        return ""


def _check_names(inventory: Sequence[SolidStone]) -> None:
    twice = [name for name, n in Counter(stone.name for stone in inventory).items() if n > 1]
    if twice:
        raise DataError(f"two stones of the inventory are called '{twice[0]}'; rename one")
