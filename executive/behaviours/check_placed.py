"""Ask whether placed stones are still where they were put."""

from pydantic import Field

from executive.config import Meters
from executive.interfaces.alignment import Aligner
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.registration import Registrar
from executive.leaf.action import Action, Steps
from executive.leaf.fitting import FittingSettings, fit
from executive.leaf.lost import mark_lost
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.messages.stone import StoneState


class CheckPlacedSettings(FittingSettings):
    position: Meters = Field(
        0.3, gt=0, le=2, description="Largest distance of a stone's centre from its place [m]."
    )


class CheckPlaced(Action[CheckPlacedSettings]):
    """Fit each placed stone's model to the newest map; one that is not seen at its place is lost.

    It belongs after a scan: a stone that fell may have pushed those that stood, and a later stone
    may have moved an earlier one. What no scan has looked at since keeps its place in the map, and
    passes.
    """

    needs = (Mapper, Aligner, Registrar, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self) -> Steps[None]:
        missing = []
        stones = self.context.use(ObjectDatabase).stones()
        placed = [stone for stone in stones if stone.state is StoneState.PLACED]
        for stone in placed:
            fitted = yield from fit(self.context, stone, self.settings)
            off_m = fitted.shift_m(stone)
            wrong = f"is not seen at its place: {fitted.refusal}" if fitted.refusal else ""
            if not wrong and off_m > self.settings.position:
                wrong = f"is {off_m:.2f} m off its place"
            if wrong:
                mark_lost(self.context, stone.id, wrong)
                missing.append(f"stone {stone.id} {wrong}")
        if missing:
            return failed("; ".join(missing))
        return succeeded(reason=f"{len(placed)} stones are seen at their places")
