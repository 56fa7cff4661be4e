"""The falls of a held stone, as the estimate of the hold tells them."""

from typing import ClassVar

from executive_plugins.monitoring.hold_state import HoldState
from executive_plugins.monitoring.settings import PayloadDropSettings

from executive.messages.verdict import Trouble


class PayloadDrop(HoldState):
    """Reports the falls of `hold_state`, and jaws that have closed on nothing.

    `jaw_slip` and `payload_drop` share its verdicts; both report jaws that have closed on nothing.
    """

    Settings = PayloadDropSettings
    name: ClassVar[str] = "payload_drop"
    told: ClassVar[frozenset[Trouble]] = frozenset({Trouble.DROP, Trouble.EMPTY})
