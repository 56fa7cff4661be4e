"""Files that `executive estimate` writes: trajectories (TUM), report (JSON), plot (PNG)."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from executive.arrays import Float
from executive.errors import ConfigError
from executive.estimate.estimator_run import Estimated
from executive.estimate.material import Material
from executive.estimate.odometry_file import write_states
from executive.estimate.plot import plot


def names_of(out: Path, exports: Sequence[Path], *, is_smoothed: bool) -> tuple[Path, ...]:
    """Return the paths of all files: trajectories in map and odometry, report, plot, the smoothed
    trajectory if there is one, and `exports`.

    Raises:
        ConfigError: If two of them would have the same name.
    """
    smoothed = (out.with_name(f"{out.stem}_smoothed{out.suffix}"),) if is_smoothed else ()
    beside = (out.with_name(f"{out.stem}_odom{out.suffix}"), out.with_suffix(".json"))
    paths = (out, *beside, out.with_suffix(".png"), *smoothed)
    if len(set(paths)) < len(paths):
        raise ConfigError(
            f"--out {out}: .json and .png are the names of report and plot; use .tum instead"
        )
    for number, path in enumerate(exports):
        if path in paths or path in exports[:number]:
            raise ConfigError(f"--export {path}: another file of this command has that name")
    return (*paths, *exports)


def write_files(
    out: Path, material: Material, estimated: Estimated, exports: Sequence[Path] = ()
) -> tuple[Path, ...]:
    """Write the chassis' poses in the map to `out`, and further files beside it.

    These are the poses in the odometry frame, the report, the plot and the reference trajectory,
    and `exports`, which hold velocity and covariance too.

    Returns:
        The paths of the files.

    Raises:
        ConfigError: If they cannot be written, or two of them would have the same name.
    """
    paths = names_of(out, exports, is_smoothed=estimated.reference is not None)
    track, origin_s = estimated.track, 1e-9 * material.log.origin_ns
    try:
        _write_tum(paths[0], origin_s + track.stamps_s, track.T_map_base)
        _write_tum(paths[1], origin_s + track.stamps_s, track.T_odom_base)
        for path in exports:
            write_states(path, estimated.replay.states, origin_s, material.rig.cabin_link)
        paths[2].write_text(json.dumps(estimated.report, indent=2) + "\n", encoding="utf-8")
        plot(paths[3], estimated, material.drops)
        if estimated.reference is not None:
            _write_tum(
                paths[4], origin_s + estimated.reference.stamps_s, estimated.reference.T_map_base
            )
    except OSError as error:
        raise ConfigError(f"{error.filename} cannot be written: {error.strerror}") from error
    return paths


def _write_tum(path: Path, stamps_s: Float, poses: Float) -> None:
    """Write lines `stamp x y z qx qy qz qw`, the TUM format that evo and others read."""
    rows = np.column_stack(
        [stamps_s, poses[:, :3, 3], Rotation.from_matrix(poses[:, :3, :3]).as_quat()]
    )
    np.savetxt(path, rows, fmt=["%.6f", *["%.5f"] * 3, *["%.7f"] * 4])
