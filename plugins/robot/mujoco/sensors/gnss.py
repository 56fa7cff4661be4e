"""An RTK GNSS antenna: its position on the ellipsoid, with white noise."""

import mujoco
import numpy as np

from executive.arrays import Float
from executive.geometry.geodesy import geodetic_from_enu
from executive.machine.sensor import Gnss
from executive.messages.gnss import GnssFix


class Antenna:
    """One GNSS antenna of the machine.

    The world frame is east-north-up at the datum. The noise has the covariance that the fix
    reports.
    """

    def __init__(
        self, gnss: Gnss, datum: Float, model: mujoco.MjModel, rng: np.random.Generator
    ) -> None:
        self.gnss = gnss
        self._datum = datum
        self._body = model.body(gnss.link).id
        self._rng = rng
        self._std_m = np.array(
            [gnss.horizontal_noise_m, gnss.horizontal_noise_m, gnss.vertical_noise_m]
        )

    def sample(self, time_s: float, data: mujoco.MjData) -> GnssFix:
        """Measure."""
        R_world_link = data.xmat[self._body].reshape(3, 3)
        position = data.xpos[self._body] + R_world_link @ self.gnss.T_link_sensor[:3, 3]
        geodetic = geodetic_from_enu(position + self._rng.normal(0.0, self._std_m), self._datum)
        return GnssFix(time_s, self.gnss.name, geodetic, np.diag(self._std_m**2), is_rtk_fixed=True)
