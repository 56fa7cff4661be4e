"""A reference trajectory by batch smoothing, and the online trajectory's difference to it."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from executive.errors import DataError
from executive.estimate.estimator_run import Estimated, map_origin, prepare
from executive.estimate.material import Material
from executive.estimate.measures import Track, fix_errors, spread, statistics
from executive.interfaces.smoothing import TrajectorySmoother
from executive.tree.choices import Choices

_DIGITS = 6


def with_reference(material: Material, estimated: Estimated, name: str) -> Estimated:
    """Smooth a whole log with all its fixes, and report the online estimate's difference to it.

    Raises:
        ConfigError: If there is no such smoother.
        DataError: If it finds no trajectory.
    """
    smoother: TrajectorySmoother = prepare(material, "smoothing", name, Choices(()))
    smoother.start()
    try:
        states = smoother.smooth(arrival.observation for arrival in material.arrivals)
    finally:
        smoother.close()
    if not states:
        raise DataError(
            f"{material.log.path}: {name} found no trajectory, since it found no first state; "
            "record some seconds at rest first"
        )
    reference = Track.of(states)
    datum = map_origin(smoother, material)
    fixes = fix_errors(reference, estimated.replay.fixes, material.rig, datum, ())
    report = {
        "smoother": name,
        **_difference(estimated.track, reference),
        "fixes_m": spread(fixes.predicted_m),
    }
    return replace(estimated, report=estimated.report | {"reference": report}, reference=reference)


def _difference(track: Track, reference: Track) -> dict[str, Any]:
    """Compare two tracks at the stamps that both have."""
    _, ours, theirs = np.intersect1d(track.stamps_s, reference.stamps_s, return_indices=True)
    T, T_reference = track.T_map_base[ours], reference.T_map_base[theirs]
    turn = np.swapaxes(T_reference[:, :3, :3], 1, 2) @ T[:, :3, :3]
    return {
        "position_m": spread(T[:, :3, 3] - T_reference[:, :3, 3]),
        "rotation_rad": statistics(Rotation.from_matrix(turn).magnitude(), _DIGITS),
    }
