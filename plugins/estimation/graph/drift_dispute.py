"""Fixes and odometry that have drifted apart: which of them is refused, and for how long both are
in doubt.
"""

import numpy as np
from executive_plugins.estimation.gate.gnss_gate import GnssGate
from executive_plugins.estimation.graph.odometry_use import OdometryUse


class DriftDispute:
    """Decides about fixes that have drifted against the odometry.

    Either of the two may have drifted, and over such a time inertial samples do not tell which. If
    fixes agree with the graph that no odometry has touched, that one is reported, and said to be in
    doubt.

    Attributes:
        reason: How fixes and odometry differed when odometry was left the last time.
    """

    def __init__(self, odometry: OdometryUse, gate: GnssGate, doubted_s: float) -> None:
        """Begin without a dispute.

        Args:
            odometry: The graphs with and without odometry.
            gate: The gate of fixes, which compares them with the odometry.
            doubted_s: How long both are in doubt after odometry was left [s].
        """
        self._odometry, self._gate, self._doubted_s = odometry, gate, doubted_s
        self.reason, self._since_s = "", -np.inf
        # Whether fixes are compared with odometry that is not used, as they contradicted its graph.
        self._still_compares = False

    def compares(self) -> bool:
        """Return whether fixes are compared with the odometry."""
        self._still_compares &= not self._odometry.is_trusted
        return self._odometry.is_trusted or self._still_compares

    def leave_contradicted(self) -> None:
        """Leave the odometry if fixes contradict the graph that uses it, and not the other one."""
        if self._odometry.gives_way():
            self._still_compares = True

    def verdict(self, stamp_s: float, refusal: str) -> str:
        """Return why a fix that has drifted is refused; empty if it is used.

        Args:
            stamp_s: Stamp of the fix [s].
            refusal: How it has drifted.
        """
        if not self._odometry.gives_way() and self._odometry.is_trusted:
            self._odometry.end_trial()  # who has drifted was decided by the gate
            return refusal
        self._gate.forget_odometry()
        self._still_compares = False
        self.reason, self._since_s = refusal, stamp_s
        return ""

    def is_open(self, now_s: float) -> bool:
        """Return whether odometry that was left for its drift may be right all the same."""
        return now_s - self._since_s < self._doubted_s and not self._odometry.is_trusted
