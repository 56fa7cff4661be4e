"""The slips of a held stone, as the estimate of the hold tells them."""

from typing import ClassVar

from executive_plugins.monitoring.hold_state import HoldState
from executive_plugins.monitoring.settings import JawSlipSettings

from executive.messages.verdict import Trouble


class JawSlip(HoldState):
    """Reports the slips of `hold_state`, and jaws that have closed on nothing.

    `jaw_slip` and `payload_drop` share its verdicts; both report jaws that have closed on nothing.
    """

    Settings = JawSlipSettings
    name: ClassVar[str] = "jaw_slip"
    told: ClassVar[frozenset[Trouble]] = frozenset({Trouble.SLIP})
