"""One position fix of one antenna."""

from dataclasses import dataclass

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class GnssFix:
    """A geodetic fix (WGS-84) of an antenna's phase centre.

    Attributes:
        stamp_s: Time of measurement [s].
        antenna: Name of the antenna's frame in the machine's description, such as `gnss_left`.
        geodetic: Latitude [deg], longitude [deg], altitude above the ellipsoid [m], shape (3,).
        covariance_enu_m2: Covariance of the position in east, north, up [m²], shape (3, 3).
        is_rtk_fixed: Whether carrier-phase ambiguities were resolved to integers (about 1 cm).
    """

    stamp_s: float
    antenna: str
    geodetic: Float
    covariance_enu_m2: Float
    is_rtk_fixed: bool

    def __post_init__(self) -> None:
        object.__setattr__(self, "geodetic", checked("geodetic", self.geodetic, 3))
        object.__setattr__(
            self, "covariance_enu_m2", checked("covariance_enu_m2", self.covariance_enu_m2, 3, 3)
        )
