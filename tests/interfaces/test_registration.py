"""A registrar need not know how to find single objects; it then refuses, and says why."""

import numpy as np

from executive.interfaces.registration import Registrar
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud


class OfMaps(Registrar):
    def register(self, target: Cloud, source: Cloud, rng: np.random.Generator) -> Alignment:
        raise NotImplementedError


def test_a_method_that_registers_maps_refuses_a_single_object() -> None:
    cloud = Cloud("map", np.zeros((3, 3)))
    answer = OfMaps().find(cloud, cloud)
    assert not answer.accepted
    assert "not single objects" in answer.reason
    assert np.array_equal(answer.T_target_source, np.eye(4))
