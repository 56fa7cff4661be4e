"""What every survey must give: a cloud in a frame of its own, in metres."""

import numpy as np

from executive.errors import DataError
from executive.interfaces.surveying import Survey
from executive.messages.cloud import Cloud
from executive.testing.pytest_plugin import Insist

CAPABILITY = "surveying"


def survey_of(plugin: Survey, insist: Insist) -> Cloud:
    """Return a survey; one that there is not ends the check with its reason."""
    try:
        return plugin.survey(np.random.default_rng(0))
    except DataError as error:
        insist(False, str(error))
        raise


def test_it_has_points_in_a_frame_of_its_own(plugin: Survey, insist: Insist) -> None:
    cloud = survey_of(plugin, insist)
    assert len(cloud) > 0, "a survey without points must be a DataError with the cure"
    assert cloud.frame, "the frame has no name"
    assert cloud.frame != "map", "the pose of a survey is unknown: its frame cannot be the map"


def test_it_is_a_site_in_metres(plugin: Survey, insist: Insist) -> None:
    extent_m = float(np.ptp(survey_of(plugin, insist).points, axis=0).max())
    assert 1.0 < extent_m < 2000.0, f"the survey is {extent_m:g} m wide: not in metres, or no site"
