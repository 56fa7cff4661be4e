"""One sample of the joint encoders and cylinder forces."""

from dataclasses import dataclass

from executive.arrays import Float, checked
from executive.errors import ShapeError


@dataclass(frozen=True, slots=True, eq=False)
class JointSample:
    """Positions, velocities and efforts of all joints, jaws last, in the machine's order.

    Attributes:
        stamp_s: Time of measurement [s].
        names: Joint names, in the order of the arrays, n of them.
        position: [rad] or, for prismatic joints, [m], shape (n,). Continuous joints are not
            wrapped.
        velocity: [rad/s] or [m/s], shape (n,).
        effort: Joint torque [N·m] or force [N] computed from cylinder pressures, shape (n,).
    """

    stamp_s: float
    names: tuple[str, ...]
    position: Float
    velocity: Float
    effort: Float

    def __post_init__(self) -> None:
        for name in ("position", "velocity", "effort"):
            object.__setattr__(self, name, checked(name, getattr(self, name), len(self.names)))

    def of(self, joint: str) -> tuple[float, float, float]:
        """Return position, velocity and effort of one joint."""
        try:
            i = self.names.index(joint)
        except ValueError:
            raise ShapeError(
                f"no joint '{joint}' in the sample; it has {', '.join(self.names)}"
            ) from None
        return float(self.position[i]), float(self.velocity[i]), float(self.effort[i])
