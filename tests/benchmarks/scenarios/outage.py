"""What an outage of the satellites costs: drift as a share of the way, and the time until they are
believed again.
"""

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse
from scenarios.streams import LIDAR
from scenarios.trial import Trial


def way_m(trial: Trial, from_s: float, to_s: float) -> float:
    """Return the distance that the lidar travels [m]: odometry drifts in proportion to it."""
    p = trial.truth.T_map_sensor(LIDAR, np.arange(from_s, to_s, 0.1))[:, :3, 3]
    return float(np.linalg.norm(np.diff(p, axis=0), axis=1).sum())


def drift_share(trial: Trial, from_s: float, to_s: float) -> float:
    """Return the largest error of the lidar's position in an outage, as a share of the whole way in
    it.
    """
    during = (trial.stamps_s > from_s) & (trial.stamps_s <= to_s)
    T_cabin_lidar = trial.truth.machine.sensors[LIDAR].T_link_sensor
    estimated, true = (T[during] @ T_cabin_lidar for T in (trial.T_map_cabin, trial.T_true))
    off_m = np.linalg.norm((estimated - true)[:, :3, 3], axis=1)
    return float(off_m.max()) / way_m(trial, from_s, to_s)


def odometry_share(trial: Trial, from_s: float, to_s: float) -> float:
    """Return the same of the lidar's increments alone, laid end to end from the true pose."""
    stamps, chain = trial.chain(from_s, to_s)
    true = trial.truth.T_map_sensor(LIDAR, stamps)
    reckoned: Float = true[0] @ inverse(chain[0]) @ chain
    return float(np.linalg.norm((reckoned - true)[:, :3, 3], axis=1).max()) / way_m(
        trial, from_s, to_s
    )


def backs_s(trial: Trial, good_from_s: float) -> float:
    """Return how long after fixes are good again the estimator says so for the first time, and
    keeps to it [s].
    """
    after = trial.stamps_s >= good_from_s
    believed = trial.is_global[after]
    if believed.all():
        return 0.0
    last = np.flatnonzero(~believed)[-1]
    return (
        float(trial.stamps_s[after][last] - good_from_s)
        if last + 1 < len(believed)
        else float(np.inf)
    )
