"""What `register` and `align` answer: to machines, and to people."""

from pathlib import Path
from typing import Any

from executive.arrays import Float
from executive.clouds.ply_writer import write_parts
from executive.clouds.units import unit_hint
from executive.errors import ConfigError
from executive.messages.alignment import Alignment


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
        "timings_ms": dict(found.timings_ms),
    }


def verdict(found: Alignment, source: Float, target: Float) -> str:
    """Say whether the motion is to be believed and why; if not, whether a unit may be wrong."""
    if found.accepted:
        return f"accepted: {found.reason}"
    hint = unit_hint(source, target)
    return f"refused: {found.reason}" + (f"; {hint}" if hint else "")


def check_out(path: Path | None) -> None:
    """Refuse an output that cannot be written, before anything is computed.

    Raises:
        ConfigError: If it is no .ply file in a folder that exists.
    """
    if path and (path.suffix.lower() != ".ply" or not path.parent.is_dir()):
        raise ConfigError(f"--out: {path}: name a .ply file in a folder that exists")


def write_both(path: Path | None, found: Alignment, source: Float, target: Float) -> None:
    """Write target and moved source, one colour each, if the motion was accepted and a path is
    given.
    """
    if path and found.accepted:
        write_parts(path, [target, found.apply(source)])
