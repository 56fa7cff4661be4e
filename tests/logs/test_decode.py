"""ROS messages become this project's messages, and one that lacks what is needed is refused."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.errors import DataError, ShapeError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.logs.decode import (
    gnss_fix,
    imu_sample,
    joint_sample,
    lidar_scan,
    pose_of,
    stamp_ns,
    transform_of,
)


def xyz(x, y, z):
    return SimpleNamespace(x=x, y=y, z=z)


HEADER = SimpleNamespace(frame_id="here", stamp=SimpleNamespace(sec=3, nanosec=250))


def test_a_stamp_counts_in_nanoseconds():
    assert stamp_ns(SimpleNamespace(header=HEADER)) == 3_000_000_250


def test_an_inertial_sample_holds_rate_and_force():
    message = SimpleNamespace(
        header=HEADER, angular_velocity=xyz(1.0, 2.0, 3.0), linear_acceleration=xyz(4.0, 5.0, 6.0)
    )
    found = imu_sample(message, 1.5)
    assert (found.stamp_s, found.frame) == (1.5, "here")
    np.testing.assert_array_equal(found.angular_velocity_rad_s, [1.0, 2.0, 3.0])
    np.testing.assert_array_equal(found.specific_force_m_s2, [4.0, 5.0, 6.0])


@pytest.mark.parametrize(("status", "is_fixed"), [(-1, None), (0, False), (1, False), (2, True)])
def test_a_fix_is_fixed_from_ground_based_augmentation_on(status, is_fixed):
    message = SimpleNamespace(
        header=HEADER,
        status=SimpleNamespace(status=status),
        latitude=47.0,
        longitude=8.0,
        altitude=400.0,
        position_covariance=list(range(9)),
    )
    found = gnss_fix(message, 1.5)
    if is_fixed is None:
        assert found is None
        return
    assert (found.is_rtk_fixed, found.antenna, found.stamp_s) == (is_fixed, "here", 1.5)
    np.testing.assert_array_equal(found.geodetic, [47.0, 8.0, 400.0])
    np.testing.assert_array_equal(found.covariance_enu_m2, np.arange(9.0).reshape(3, 3))


def joints(velocity, effort):
    return SimpleNamespace(name=["a", "b"], position=[1.0, 2.0], velocity=velocity, effort=effort)


def test_joints_without_efforts_have_none_and_without_velocities_are_refused():
    found = joint_sample(joints([3.0, 4.0], []), 1.5)
    np.testing.assert_array_equal(found.effort, [0.0, 0.0])
    np.testing.assert_array_equal(found.velocity, [3.0, 4.0])
    np.testing.assert_array_equal(joint_sample(joints([0, 0], [5.0, 6.0]), 1.5).effort, [5.0, 6.0])
    told = "2 joints with 0 velocities; record the velocities too"
    with pytest.raises(DataError, match=told):
        joint_sample(joints([], [5.0, 6.0]), 1.5)


KINDS = {"f4": 7, "f8": 8, "u4": 6, "u2": 4}


def scan(rows, fields, *, big=False, gap=0, width=None):
    """Return a point cloud of rows, each a tuple, with fields of a name and a type."""
    order = ">" if big else "<"
    offsets = np.cumsum([0, *(np.dtype(kind).itemsize + gap for _, kind in fields)])
    kind = np.dtype(
        {
            "names": [name for name, _ in fields],
            "formats": [order + one for _, one in fields],
            "offsets": offsets[:-1].tolist(),
            "itemsize": int(offsets[-1]),
        }
    )
    data = np.array(rows, dtype=kind)
    described = [
        SimpleNamespace(name=name, datatype=KINDS[one], offset=int(offset))
        for (name, one), offset in zip(fields, offsets, strict=False)
    ]
    return SimpleNamespace(
        header=HEADER,
        fields=described,
        is_bigendian=big,
        point_step=kind.itemsize,
        width=len(data) if width is None else width,
        height=1,
        data=data.tobytes(),
    )


XYZ = [("x", "f4"), ("y", "f4"), ("z", "f4")]


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("gap", [0, 4])
def test_points_are_read_in_either_order_of_bytes_with_gaps_between(big, gap):
    found = lidar_scan(scan([(1, 2, 3), (4, 5, 6)], XYZ, big=big, gap=gap), 7.0)
    np.testing.assert_array_equal(found.points_lidar, [[1, 2, 3], [4, 5, 6]])
    np.testing.assert_array_equal(found.point_stamps_s, [7.0, 7.0])
    assert found.stamp_s == 7.0


@pytest.mark.parametrize(
    ("name", "kind", "times"),
    [("time", "f4", (0.5, 0.25)), ("t", "u4", (500_000_000, 250_000_000))],
)
def test_points_are_sorted_by_their_times_and_the_scan_is_of_its_last(name, kind, times):
    rows = [(1, 2, 3, times[0]), (4, 5, 6, times[1])]
    found = lidar_scan(scan(rows, [*XYZ, (name, kind)]), 7.0)
    np.testing.assert_array_equal(found.points_lidar, [[4, 5, 6], [1, 2, 3]])
    np.testing.assert_allclose(found.point_stamps_s, [7.25, 7.5])
    assert found.stamp_s == pytest.approx(7.5)


def test_returns_that_are_not_finite_are_left_out():
    nan = float("nan")
    rows = [(1, nan, 3, 0.1), (4, 5, 6, 0.2), (7, 8, 9, nan), (1, 1, float("inf"), 0.0)]
    found = lidar_scan(scan(rows, [*XYZ, ("time", "f4")]), 7.0)
    np.testing.assert_array_equal(found.points_lidar, [[4, 5, 6]])
    empty = lidar_scan(scan([(nan, 0, 0)], XYZ), 7.0)
    assert (len(empty.points_lidar), empty.stamp_s) == (0, 7.0)


def test_a_cloud_without_coordinates_is_told_with_its_fields():
    with pytest.raises(DataError, match="a point cloud without y, z; its fields are x, range"):
        lidar_scan(scan([(1, 2)], [("x", "f4"), ("range", "u2")]), 7.0)
    odd = scan([(1, 2, 3)], XYZ)
    for one in odd.fields:
        one.datatype = 9
    with pytest.raises(DataError, match="a point cloud without x, y, z; its fields are none"):
        lidar_scan(odd, 7.0)


HALF = np.sqrt(0.5)


def turn(length=1.0):
    return SimpleNamespace(x=0.0, y=0.0, z=length * HALF, w=length * HALF)


def test_poses_and_transforms_turn_by_their_quaternion():
    expected = pose(from_rpy(0.0, 0.0, np.pi / 2), np.array([1.0, 2.0, 3.0]))
    of = pose_of(SimpleNamespace(position=xyz(1.0, 2.0, 3.0), orientation=turn()))
    np.testing.assert_allclose(of, expected, atol=1e-12)
    of = transform_of(SimpleNamespace(translation=xyz(1.0, 2.0, 3.0), rotation=turn(1.09)))
    np.testing.assert_allclose(of, expected, atol=1e-12)


@pytest.mark.parametrize("length", [0.0, 0.89, 1.11])
def test_a_quaternion_of_another_length_is_refused(length):
    with pytest.raises(ShapeError, match=f"a quaternion of length {length:.3g}; a rotation has"):
        pose_of(SimpleNamespace(position=xyz(0, 0, 0), orientation=turn(length)))
