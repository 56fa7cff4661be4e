"""How a machine drives: its limits on wheels or tracks, and the arm's posture meanwhile."""

from pydantic import Field

from executive.machine.provenance import Sourced


class Driving(Sourced):
    """Limits of the chassis while it drives, and the posture in which the arm travels."""

    max_speed_m_s: float = Field(gt=0, le=10, description="Largest speed, forwards and back [m/s].")
    max_acceleration_m_s2: float = Field(
        gt=0, le=10, description="Largest acceleration, braking included [m/s²]."
    )
    least_radius_m: float = Field(
        gt=0, le=100, description="Least turning radius of the base frame's origin [m]."
    )
    max_steering_1_ms: float = Field(
        gt=0, le=100, description="Largest change of the path's curvature in time [1/(m·s)]."
    )
    max_slope_rad: float = Field(
        gt=0, lt=1.2, description="Steepest ground, in any direction, that it drives on [rad]."
    )
    step_m: float = Field(
        gt=0, le=1, description="Highest step of the ground that it drives over [m]."
    )
    legs_s: float = Field(
        0.0,
        ge=0,
        le=120,
        description="How long the machine takes at most to raise its legs before it drives, and to "
        "stand on them again after it [s]; 0 if it works on its wheels. A simulated robot sets it.",
    )
    posture: str = Field("scan", description="Posture of the arm while the machine drives.")

    @property
    def max_curvature_1_m(self) -> float:
        """Largest curvature of the path [1/m]."""
        return 1.0 / self.least_radius_m

    def stop_s(self, speed_m_s: float) -> float:
        """Return how long braking takes at the limit [s]."""
        return abs(speed_m_s) / self.max_acceleration_m_s2
