"""How a machine stands, and what it can do as a whole."""

from pydantic import Field

from executive.machine.provenance import Sourced

# Slowest sway on supports that yield that is reckoned with [s]: 12 t on tyres of 0.33 MN/m with
# 2.6 t at 7 m. A machine that stands on one side of its supports alone has none: it tips.
SLOWEST_S = 2.5
# Share of what holds the empty machine that a load, as it comes on and sways, leaves for what the
# model of the machine errs.
LEFT = 0.1
_SETTLED = 5.834  # ωt at which (1 + ωt) exp(−ωt) is 2 %


class Stance(Sourced):
    """Height of the chassis, and capabilities of the machine as a whole."""

    base_height_m: float = Field(
        gt=0, description="Height of the base frame above level ground [m]."
    )
    payload_kg: float = Field(gt=0, description="Heaviest load of the gripper [kg].")
    reach_m: float = Field(
        gt=0, description="Largest distance of the tips from the turning axis [m]."
    )
    supports_m: tuple[tuple[float, float], ...] = Field(
        (),
        description="Points (x, y) of the base frame on which the machine stands [m]; tipping is "
        "not computed without.",
    )
    is_free: bool = Field(
        False,
        description="Whether the machine stands on the ground and may tip; then the rated lift "
        "capacity limits lifts unless a mission says otherwise. A simulated robot sets it.",
    )
    support_n_m: float | None = Field(
        None,
        gt=0,
        description="Stiffness of each point of support [N/m], by which a machine that stands free "
        "leans with its arm and sways with a load; it is taken to do neither without. A simulated "
        "robot sets it.",
    )
    tracking_error: float = Field(
        0.1,
        gt=0,
        description="Largest distance of a moving joint from its path [rad] or [m].",
    )
    tracking_lag_s: float = Field(
        0.2, ge=0, lt=2, description="Largest delay of a joint behind its path [s]."
    )

    def limits_by_tipping(self, rule: str) -> bool:
        """Return whether the rated lift capacity limits lifts by a rule of a mission."""
        return rule == "iso_10567" or (rule == "by_base" and self.is_free)

    @property
    def longest_stop_s(self) -> float:
        """How long a stop may last that spares a machine on supports that yield [s]; 0 without."""
        return 0.0 if self.support_n_m is None else SLOWEST_S

    @property
    def settling_s(self) -> float:
        """How long a joint may need to be back on its path after its load has changed at once [s].

        A critically damped position drive of natural frequency ω is 2/ω behind a ramp, and a
        disturbance leaves (1 + ωt) exp(−ωt) of its deflection, 2 % after ωt = 5.83: the settling
        time of Franklin, Powell and Emami-Naeini, Feedback Control of Dynamic Systems, Sec. 3.4.
        """
        return 0.5 * _SETTLED * self.tracking_lag_s
