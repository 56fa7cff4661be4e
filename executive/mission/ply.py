"""Clouds as binary PLY files."""

from pathlib import Path

import numpy as np

from executive.messages.cloud import Cloud


def write_ply(path: Path, cloud: Cloud) -> None:
    """Write points [m] as little-endian doubles, with the frame's name as a comment."""
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"comment frame {cloud.frame}\nelement vertex {len(cloud)}\n"
        "property double x\nproperty double y\nproperty double z\nend_header\n"
    )
    path.write_bytes(
        header.encode("ascii") + np.ascontiguousarray(cloud.points, dtype="<f8").tobytes()
    )
