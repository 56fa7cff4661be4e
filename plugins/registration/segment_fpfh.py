"""Registration on segments whose motions come from FPFH descriptors and from constellations."""

from dataclasses import dataclass
from importlib import import_module

from executive_plugins.registration.consistency import consistent_transforms
from executive_plugins.registration.constellation import Constellation
from executive_plugins.registration.features import match
from executive_plugins.registration.motion_proposer import MotionProposer
from executive_plugins.registration.segment_registrar import SegmentRegistrar
from executive_plugins.registration.settings import SegmentFpfhSettings
from executive_plugins.registration.stopwatch import Stopwatch

from executive.arrays import Float
from executive.extras import require_extra
from executive.interfaces.alignment import Aligner
from executive.interfaces.segmentation import Segmenter
from executive.messages.segment import Segmentation


def load_open3d() -> None:
    """Import open3d, which takes a second, before the first registration.

    Raises:
        MissingExtraError: If it is not installed.
    """
    require_extra("registration 'segment_fpfh'", "fpfh")
    import_module("executive_plugins.registration.fpfh_features")


@dataclass(frozen=True, slots=True)
class FpfhAndConstellation(MotionProposer):
    """Propose from groups of consistent matches, then from where the segments stand
    (steps 2 to 4).
    """

    settings: SegmentFpfhSettings

    def propose(self, target: Segmentation, source: Segmentation, watch: Stopwatch) -> list[Float]:
        """Return the motions of both origins; see `MotionProposer.propose`."""
        from executive_plugins.registration.fpfh_features import describe

        s = self.settings
        with watch.stage("description"):
            there, here = (
                describe(x.segments, s.feature_voxel_m, s.iss_radius_m, s.fpfh_radius_m)
                for x in (target, source)
            )
        with watch.stage("matching"):
            matched = match(there, here, s.nearest)
        with watch.stage("verification"):
            described = consistent_transforms(
                *matched, s.consistency_m, s.max_scale_error, s.candidates
            )
        return [*described, *Constellation(s).propose(target, source, watch)]


class SegmentFpfh(SegmentRegistrar):
    """Registration by segments with FPFH, and constellations of centroids beside it."""

    Settings = SegmentFpfhSettings

    def __init__(
        self, settings: SegmentFpfhSettings, segmentation: Segmenter, alignment: Aligner
    ) -> None:
        super().__init__(settings, segmentation, alignment)
        self._proposer = FpfhAndConstellation(settings)

    def start(self) -> None:
        """Load what describes keypoints."""
        super().start()
        load_open3d()

    def _proposers(self) -> tuple[MotionProposer, ...]:
        return (self._proposer,)
