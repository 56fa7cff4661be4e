"""A fix of an antenna whose place on the body and whose clock are unknown."""

import gtsam
import numpy as np

from executive.arrays import Float
from executive.geometry import chi_square
from executive.geometry.rotation import skew

_HUBER = float(np.sqrt(chi_square.quantile(0.95, 3)))  # one in twenty distances counts linearly


def unknown_arm_factor(
    keys: tuple[int, int, int, int], p_map_antenna: Float, covariance: Float, rate_imu: Float
) -> gtsam.NonlinearFactor:
    """Return a factor on |p_a − d v_a − z| with p_a = p + R l and v_a = v + R (ω × l).

    The motion over d is taken as straight, so that d must be small: whoever solves for it moves
    the stamps by what was found, and solves again.

    Args:
        keys: Of the pose, the velocity, the arm l in IMU axes [m] and the delay d of the stamp [s].
        p_map_antenna: The fix z [m], shape (3,).
        covariance: Of the fix [m²], shape (3, 3).
        rate_imu: Angular velocity ω in IMU axes [rad/s], shape (3,).
    """
    z, spin = p_map_antenna, skew(rate_imu)

    def error(this: gtsam.CustomFactor, values: gtsam.Values, H: list[Float] | None) -> Float:
        x, v, a, d = this.keys()
        T, velocity, arm = values.atPose3(x), values.atVector(v), values.atVector(a)
        late_s = float(values.atVector(d)[0])
        R = T.rotation().matrix()
        from_imu = arm - late_s * (spin @ arm)
        if H is not None:
            H[0] = np.hstack([-R @ skew(from_imu), R])
            H[1] = -late_s * np.eye(3)
            H[2] = R @ (np.eye(3) - late_s * spin)
            H[3] = -(velocity + R @ (spin @ arm))[:, None]
        return np.asarray(T.translation() + R @ from_imu - late_s * velocity - z)

    gaussian = gtsam.noiseModel.Gaussian.Covariance(covariance)
    huber = gtsam.noiseModel.mEstimator.Huber.Create(_HUBER)
    return gtsam.CustomFactor(gtsam.noiseModel.Robust.Create(huber, gaussian), list(keys), error)
