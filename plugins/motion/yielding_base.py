"""What a base that may tip, on supports that may yield, asks of a motion with a held stone."""

from collections.abc import Sequence
from functools import cached_property

from executive_plugins.motion.carried_load import CarriedLoad
from executive_plugins.motion.easing import Easing

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import Machine
from executive.machine.sway import Sway
from executive.machine.tipping_moment import TippingMoment
from executive.messages.request import Around, MoveRequest, PostureRequest
from executive.messages.stone import STONE_DENSITY_KG_M3

Request = MoveRequest | PostureRequest | Around


class YieldingBase:
    """The base of one machine.

    Args:
        machine: The machine; on a base that is fixed to the ground it asks for nothing.
        rule: Whether the rated lift capacity limits lifts; see `HermiteSettings.lift_capacity`.
    """

    def __init__(self, machine: Machine, rule: str) -> None:
        self._machine, self._may_tip = machine, machine.stance.limits_by_tipping(rule)
        self._yields = machine.stance.support_n_m is not None

    def load(self, request: Request) -> CarriedLoad | None:
        """Return the stone in the jaws of a machine that may tip; None if nobody has weighed it.

        It counts with the payload at most: nowhere does the machine lift more, and a stone of about
        the payload, of which the most that it may weigh is asked about, would find no way.
        """
        if not self._may_tip or request.held_gripper is None or request.held_kg is None:
            return None
        return CarriedLoad(self._capacity, min(request.held_kg, self._machine.payload_kg))

    def easing(self, request: Request) -> Easing | None:
        """Return how a motion is eased; None where nothing yields, or with an unknown load.

        The joints keep the limits of a full load while nobody has weighed it.
        """
        if not (self._may_tip and self._yields):
            return None
        if request.held_gripper is None:
            return Easing(self._moment, self._sway, 0.0)
        if request.held_kg is None:
            return None
        held_kg = min(request.held_kg, self._machine.payload_kg)
        return Easing(self._moment, self._sway, held_kg)

    def sway_s(self, request: Request, postures: Sequence[Float]) -> float:
        """Return the longest period of the sway with the stone of a request in some postures [s].

        A stone that nobody has weighed has the mass of its hull. It is 0 where nothing yields.
        """
        if not self._yields or request.held_gripper is None:
            return 0.0
        load_kg = request.held_kg
        if load_kg is None:
            load_kg = STONE_DENSITY_KG_M3 * volume_and_centroid(request.held_gripper)[0]
        return max(self._sway.period_s(q, load_kg) for q in postures)

    @cached_property
    def _capacity(self) -> LiftCapacity:
        return LiftCapacity(self._machine)

    @cached_property
    def _moment(self) -> TippingMoment:
        return TippingMoment(self._machine)

    @cached_property
    def _sway(self) -> Sway:
        return Sway(self._machine)
