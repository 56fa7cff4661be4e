"""The model of a stone of the site includes its foot."""

from dataclasses import replace

import numpy as np
import pytest

from executive.behaviours.segment import SegmentMap
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation

FOOT = np.array([[5.0, 0.3, 0.04], [5.1, 0.3, 0.05], [4.9, 0.3, 0.06]])


def _segmented(points: np.ndarray, foot: np.ndarray) -> Segmentation:
    whole = Segment(0, points, points.mean(axis=0), np.ptp(points, axis=0))
    flat = np.array([0.0, 0.0, 1.0, 0.0])
    return Segmentation("map", (replace(whole, foot=foot),), Cloud("map", foot), flat)


@pytest.mark.parametrize("foot", [FOOT, FOOT[:0]])
def test_the_stones_of_a_site_have_their_feet(stage, database, foot) -> None:
    above = stage.block((5.0, 0.0, 0.6))
    segmenter = stage.Scripted(
        Segmenter, segment=_segmented(above, foot), merge=lambda clouds: clouds[0]
    )
    stand = stage.Stage(mapping=stage.PointMap(above), segmentation=segmenter, objects=database)
    assert stand.tick(SegmentMap).status == "SUCCESS"
    lowest_m = foot[:, 2].min() if len(foot) else above[:, 2].min()
    model = database.stone(1).points_map
    assert model[:, 2].min() == pytest.approx(lowest_m, abs=0.03)
