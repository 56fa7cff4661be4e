"""Whether a refined motion is accepted: by the stones that it brings together, and by its rival."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from executive_plugins.registration.gate import NOTHING, Agreement, measure
from executive_plugins.registration.matchup import Matchup, centroids
from executive_plugins.registration.rivals import RivalSearch
from executive_plugins.registration.settings import SegmentSettings
from executive_plugins.registration.similarity import Similarity

from executive.arrays import Float
from executive.geometry.rotation import angle_between
from executive.messages.alignment import Alignment, Rival


def judge(clouds: Matchup, fine: Similarity) -> Alignment:
    """Accept or refuse a motion by the segments whose centroids have been matched (step 5)."""
    s = clouds.settings
    agreements = {
        (i, j): measure(
            clouds.target.segments[j].points,
            fine.apply(clouds.source.segments[i].points),
            s.truncation_m,
            s.voxel_m,
        )
        for i, j in clouds.matched(fine)
    }
    agreeing = tuple(pair for pair, a in agreements.items() if a.better.share >= s.min_overlap)
    whole = sum(agreements.values(), NOTHING)
    faults = _faults(s, whole, len(agreeing))
    reason = "; ".join(faults) or f"{len(agreeing)} stones agree, {whole}"
    return Alignment(
        T_target_source=fine.T_target_source,
        accepted=not faults,
        reason=reason,
        rmse_m=whole.better.rmse_m,
        overlap=whole.source.share,
        matched_segments=agreeing,
        scale=fine.scale,
    )


def against_rivals(clouds: Matchup, found: Alignment, candidates: Sequence[Float]) -> Alignment:
    """Look for the best rival of an accepted motion, and refuse if it explains the site as well.

    Args:
        clouds: Both clouds.
        found: The accepted motion.
        candidates: Motions among which a rival is looked for, each (4, 4).
    """
    best = Similarity(found.T_target_source, found.scale)
    search = RivalSearch(clouds, len(candidates))
    rival = search.best_rival(best, found.matched_segments, candidates)
    if rival is None:
        told = "no other motion fits two stones"
        if search.excluded:
            told += f" (plain ground under other stones excludes {search.excluded})"
        return replace(found, reason=f"{found.reason}; {told}")
    told = _told(rival, best, centroids(clouds.source.segments).mean(axis=0))
    if rival.likelihood_ratio <= search.limit:
        return replace(found, rival=rival, reason=f"{found.reason}; {told}")
    reason = f"two motions explain the site: {found.reason}; {told}"
    return replace(found, rival=rival, reason=reason, accepted=False)


def _faults(settings: SegmentSettings, agreement: Agreement, stones: int) -> list[str]:
    faults = []
    if stones < settings.min_matched:
        faults.append(f"{stones} stones agree, need {settings.min_matched}")
    best = agreement.better
    if best.rmse_m > settings.max_rmse_m:
        limit = f"{settings.max_rmse_m * 100:.1f} cm"
        faults.append(f"rmse {best.rmse_m * 100:.1f} cm above {limit}")
    if best.share < settings.min_overlap:
        faults.append(f"overlap {best.share:.2f} below {settings.min_overlap}")
    return faults


def _told(rival: Rival, best: Similarity, middle: Float) -> str:
    other = Similarity(rival.T_target_source, rival.scale)
    shift_m = float(np.linalg.norm(other.apply(middle) - best.apply(middle)))
    turn_rad = angle_between(other.T_target_source[:3, :3], best.T_target_source[:3, :3])
    return (
        f"another motion, {shift_m:.2f} m and {np.degrees(turn_rad):.0f} deg away, on which "
        f"{len(rival.matched_segments)} stones agree, is {rival.likelihood_ratio:.1e} times as "
        "likely"
    )
