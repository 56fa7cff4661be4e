"""An inertial measurement unit, with white noise and random-walk biases."""

import math

import mujoco
import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import exp_so3, log_so3
from executive.machine.sensor import Imu
from executive.messages.imu import ImuSample


class MountedImu:
    """One IMU of the machine.

    A sample is the mean since the last one, as after an anti-aliasing filter: angular rate from the
    change of orientation, specific force from the change of the mount's velocity. Integrating the
    samples reproduces the motion.
    """

    def __init__(self, imu: Imu, model: mujoco.MjModel, rng: np.random.Generator) -> None:
        self.imu = imu
        self._model = model
        self._body = model.body(imu.link).id
        self._rng = rng
        self._gyro_bias = rng.normal(0.0, imu.gyro_bias_rad_s, 3)
        self._accel_bias = rng.normal(0.0, imu.accel_bias_m_s2, 3)
        self._last: tuple[float, Float, Float] | None = None
        self._R_link_imu = np.ascontiguousarray(imu.T_link_sensor[:3, :3])
        self._arm_link = imu.T_link_sensor[:3, 3].copy()
        self._gravity = np.array(model.opt.gravity)

    def sample(self, time_s: float, data: mujoco.MjData) -> ImuSample | None:
        """Measure; None at the first call, when there is no interval to average over."""
        R, v = self._motion(data)
        last, self._last = self._last, (time_s, R, v)
        if last is None:
            return None
        dt = time_s - last[0]
        turn = log_so3(last[1].T @ R)
        R_middle = last[1] @ exp_so3(turn / 2)
        force = R_middle.T @ ((v - last[2]) / dt - self._gravity)
        imu, (gyro_step, accel_step, gyro_noise, accel_noise) = (
            self.imu,
            self._rng.standard_normal((4, 3)),
        )
        self._gyro_bias = self._gyro_bias + imu.gyro_walk_rad_s * math.sqrt(dt) * gyro_step
        self._accel_bias = self._accel_bias + imu.accel_walk_m_s2 * math.sqrt(dt) * accel_step
        return ImuSample(
            time_s,
            imu.name,
            turn / dt + self._gyro_bias + imu.gyro_noise_rad_s * gyro_noise,
            force + self._accel_bias + imu.accel_noise_m_s2 * accel_noise,
        )

    @property
    def biases(self) -> tuple[Float, Float]:
        """Biases of gyroscope [rad/s] and accelerometer [m/s²], shape (3,) each."""
        return self._gyro_bias, self._accel_bias

    def begin_again(self, biases: tuple[Float, Float]) -> None:
        """Take back biases; the next sample is the first."""
        self._gyro_bias, self._accel_bias = biases
        self._last = None

    def _motion(self, data: mujoco.MjData) -> tuple[Float, Float]:
        """Return R_world_imu and the velocity of the mount in the world [m/s]."""
        twist = np.zeros(6)  # angular, then linear, of the body's frame, in world axes
        mujoco.mj_objectVelocity(self._model, data, mujoco.mjtObj.mjOBJ_XBODY, self._body, twist, 0)
        R_world_link = data.xmat[self._body].reshape(3, 3)
        x, y, z = (R_world_link @ self._arm_link).tolist()
        a, b, c, *linear = twist.tolist()
        v = (linear[0] + b * z - c * y, linear[1] + c * x - a * z, linear[2] + a * y - b * x)
        return R_world_link @ self._R_link_imu, np.array(v)
