"""The rig of a log that has only static transforms."""

from types import SimpleNamespace as Message

import numpy as np
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


def turned(parent: str, child: str, x: float, yaw_rad: float = 0.0):
    return Message(
        header=Message(frame_id=parent),
        child_frame_id=child,
        transform=Message(
            translation=Message(x=x, y=0.0, z=0.0),
            rotation=Message(x=0.0, y=0.0, z=np.sin(yaw_rad / 2), w=np.cos(yaw_rad / 2)),
        ),
    )


def test_transforms_from_the_root_are_chained_in_order():
    chain = [turned("base", "mast", 1.0, np.pi / 2), turned("mast", "top", 2.0, 0.3)]
    rig = rig_from(chain, {"top": "imu", "mast": "gnss"}, "a.mcap")
    assert rig.sensors["top"].xyz_m == pytest.approx((1.0, 2.0, 0.0))
    assert rig.sensors["top"].rpy_rad == pytest.approx((0.0, 0.0, np.pi / 2 + 0.3))
    assert rig.sensors["mast"].rpy_rad == pytest.approx((0.0, 0.0, np.pi / 2))
    assert (rig.sensors["top"].kind, rig.sensors["mast"].kind) == ("imu", "gnss")


def test_a_sensor_that_no_transform_places_is_refused_with_the_nearest_name():
    with pytest.raises(DataError, match=r"a\.mcap: tf_static has no frame 'topp'.*'top'"):
        rig_from([TRANSFORM], {"topp": "imu"}, "a.mcap")


def test_a_sensor_on_another_body_is_refused():
    with pytest.raises(DataError, match="does not connect lidar to 'base'"):
        rig_from([TRANSFORM, turned("cart", "lidar", 1.0)], {"top": "imu", "lidar": "points"}, "a")


def test_transforms_in_a_circle_are_refused():
    with pytest.raises(DataError, match="form a cycle at"):
        rig_from([turned("a", "b", 1.0), turned("b", "a", 1.0)], {"b": "imu"}, "a.mcap")
