"""What `register` and `align` answer: to machines, and to people."""

from typing import Any

from executive.arrays import Float
from executive.clouds.units import unit_hint
from executive.commands.clouds.view import near_origin
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud


def alignment_answer(found: Alignment) -> dict[str, Any]:
    """Return an alignment as plain values, SI units in the names."""
    return {
        "T": found.T_target_source.tolist(),
        "accepted": found.accepted,
        "reason": found.reason,
        "rmse_m": found.rmse_m,
        "overlap": found.overlap,
        "matched_segments": [list(pair) for pair in found.matched_segments],
        "scale": found.scale,
        "is_final": found.is_final,
        "rival": _rival(found),
        "uncertainty": _uncertainty(found),
        "timings_ms": dict(found.timings_ms),
    }


def _rival(found: Alignment) -> dict[str, Any] | None:
    rival = found.rival
    if rival is None:
        return None
    return {
        "T": rival.T_target_source.tolist(),
        "scale": rival.scale,
        "likelihood_ratio": rival.likelihood_ratio,
        "matched_segments": [list(pair) for pair in rival.matched_segments],
    }


def _uncertainty(found: Alignment) -> dict[str, Any] | None:
    doubt = found.uncertainty
    if doubt is None:
        return None
    return {"covariance": doubt.covariance.tolist(), "centre": doubt.centre.tolist()}


def verdict(found: Alignment, source: Float, target: Float) -> str:
    """Say whether the motion was accepted and why; if not, whether a unit may be wrong."""
    if found.accepted:
        return f"accepted: {found.reason}"
    hint = unit_hint(source, target)
    return f"refused: {found.reason}" + (f"; {hint}" if hint else "")


def alignment_view(found: Alignment, source: Float, target: Float) -> dict[str, object]:
    """Return what `--view` shows: the verdict, the target, and the source over it if accepted."""
    offset = near_origin(target)
    shown: dict[str, object] = {"alignment": found, "target": Cloud("map", target - offset)}
    if found.accepted:
        shown["drone"] = Cloud("map", found.apply(source) - offset)
    return shown
