"""Correct a moved stone's pose on the new map."""

from executive.events.stone import StoneRealigned
from executive.interfaces.alignment import Aligner
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.registration import Registrar
from executive.leaf.action import Action, Steps
from executive.leaf.fitting import FittingSettings, fit
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded


class RelocateAndRealignSettings(FittingSettings):
    """Margins and gates of the fit."""


class RelocateAndRealign(Action[RelocateAndRealignSettings]):
    """Correct a relocated stone's pose by aligning its model with the new map.

    It needs a scan of the stone's new place. A stone that settled beyond the aligner's basin is
    looked for by registration, in any orientation. A stone that registration refuses, too, was not
    seen: this fails, and the pose from the gripper's motion (Eq. 3) is kept.

    Source: Mascaro et al. 2020, Sec. 4.5.
    """

    needs = (Mapper, Aligner, Registrar, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, stone: int) -> Steps[None]:
        """Align, or register, and store the corrected pose.

        Args:
            stone: Id of the stone.
        """
        objects = self.context.use(ObjectDatabase)
        known = objects.stone(stone)
        fitted = yield from fit(self.context, known, self.settings)
        alignment, refusal = fitted.alignment, fitted.refusal
        if not refusal:
            note = f"{fitted.method}, {alignment.reason}"
            known = objects.realign(stone, alignment.T_target_source, self.context.now_s(), note)
        self.context.record(
            StoneRealigned(
                stone=stone,
                accepted=not refusal,
                method=fitted.method,
                reason=refusal,
                rmse_m=alignment.rmse_m,
                overlap=alignment.overlap,
                estimated_pose=known.T_map_object,
            )
        )
        self.context.show(f"stones/{stone}", known)
        if refusal:
            return failed(f"kept the pose from the gripper's motion: {refusal}")
        return succeeded(reason=f"realigned by {fitted.method}")
