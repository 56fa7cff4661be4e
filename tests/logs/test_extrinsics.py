"""The rig of a log that has only static transforms."""

from types import SimpleNamespace as Message

import pytest

from executive.errors import DataError
from executive.logs.extrinsics import rig_from

TRANSFORM = Message(
    header=Message(frame_id="base"),
    child_frame_id="top",
    transform=Message(
        translation=Message(x=0.0, y=0.0, z=2.0), rotation=Message(x=0.0, y=0.0, z=0.0, w=1.0)
    ),
)


def test_a_log_without_an_imu_is_refused_with_the_cure():
    with pytest.raises(DataError, match=r"a\.mcap: no topic has IMU messages.*--machine"):
        rig_from([TRANSFORM], {"top": "points"}, "a.mcap")


def test_the_root_of_the_tree_carries_the_sensors():
    rig = rig_from([TRANSFORM], {"top": "imu"}, "a.mcap")
    assert (rig.name, rig.sensors["top"].xyz_m) == ("base", (0.0, 0.0, 2.0))
