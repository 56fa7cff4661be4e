"""Plot of a replay: the path from above, and the errors against the fixes over time."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from executive.estimate.drop import Drop
from executive.estimate.estimator_run import Estimated

_SMALLEST_M = 1e-4  # smaller values are drawn as this one on the logarithmic axis


def plot(path: Path, estimated: Estimated, drops: Sequence[Drop]) -> None:
    """Draw one replay and save it as PNG."""
    track, errors = estimated.track, estimated.errors
    figure = Figure(figsize=(11, 5), layout="constrained")
    above, over_time = figure.subplots(1, 2)
    above.plot(*errors.p_map_antenna[:, :2].T, ".", color="0.75", label="fixes")
    above.plot(*track.T_map_base[:, :2, 3].T, "-", linewidth=1, label="estimate, map frame")
    above.plot(*track.T_odom_base[:, :2, 3].T, "--", linewidth=1, label="estimate, odometry frame")
    if estimated.reference is not None:
        above.plot(
            *estimated.reference.T_map_base[:, :2, 3].T,
            ":",
            linewidth=1,
            label="batch smoothing",
        )
    above.set(
        xlabel="east [m]", ylabel="north [m]", aspect="equal", title=estimated.report["estimator"]
    )
    above.legend(loc="best", fontsize="small")
    for name, vectors in (
        ("prediction", errors.predicted_m),
        ("after the fix", errors.posterior_m),
    ):
        distance_m = np.maximum(np.linalg.norm(vectors, axis=1), _SMALLEST_M)
        over_time.semilogy(errors.stamps_s, distance_m, ".", markersize=3, label=name)
    for drop in drops:
        over_time.axvspan(drop.from_s, drop.to_s, color="0.9")
    over_time.set(
        xlabel="time [s]", ylabel="distance from the fix [m]", title="error; outages in grey"
    )
    over_time.legend(loc="best", fontsize="small")
    figure.savefig(path, dpi=120)
