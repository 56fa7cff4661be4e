"""Every message checks its arrays at construction, names the wrong one, and is read-only
afterwards.
"""

from collections.abc import Callable
from dataclasses import FrozenInstanceError, fields
from importlib import import_module
from pkgutil import iter_modules

import numpy as np
import pytest
from executive_plugins.estimation.live.packed_state import PackedState

import executive.messages
from executive.errors import DataError, ShapeError
from executive.geometry.polygon import Box
from executive.messages.alignment import Alignment, Rival, Uncertainty
from executive.messages.base_state import BaseState
from executive.messages.building import BuildTarget, FailedRelease, StandingStone
from executive.messages.cloud import Cloud
from executive.messages.drive import BasePath, DriveRequest
from executive.messages.gnss import GnssFix
from executive.messages.grasp import Grasp
from executive.messages.ground_below import GroundBelow
from executive.messages.height_grid import HeightGrid
from executive.messages.hold import Hold
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.mark import Mark
from executive.messages.motion import Motion
from executive.messages.odometry import LidarIncrement
from executive.messages.placement import Placement, Slot
from executive.messages.region import Region
from executive.messages.request import Around, MotionPlan, MoveRequest, PostureRequest
from executive.messages.sector import Sector
from executive.messages.segment import LeftOut, PartKind, Segment, Segmentation
from executive.messages.slot_layout import Row
from executive.messages.solid_stone import SolidStone
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent
from executive.messages.structure import Structure
from executive.messages.trajectory import JointTrajectory

T, P, V6 = np.eye(4), np.zeros((5, 3)), np.eye(6)
CORNER = np.vstack([np.zeros(3), np.eye(3)])  # of a cube


def zeros() -> np.ndarray:
    return np.zeros(3)


MESSAGES: dict[type, Callable[[], dict[str, object]]] = {
    ImuSample: lambda: {
        "stamp_s": 0.0,
        "frame": "imu",
        "angular_velocity_rad_s": zeros(),
        "specific_force_m_s2": zeros(),
    },
    GnssFix: lambda: {
        "stamp_s": 0.0,
        "antenna": "left",
        "geodetic": zeros(),
        "covariance_enu_m2": np.eye(3),
        "is_rtk_fixed": True,
    },
    JointSample: lambda: {
        "stamp_s": 0.0,
        "names": ("a", "b"),
        "position": [0, 1],
        "velocity": [0, 0],
        "effort": [0, 0],
    },
    LidarScan: lambda: {
        "stamp_s": 0.0,
        "frame": "lidar",
        "points_lidar": P.copy(),
        "point_stamps_s": np.zeros(5),
    },
    LidarIncrement: lambda: {
        "from_s": 0.0,
        "to_s": 0.1,
        "frame": "lidar",
        "T_from_to": T.copy(),
        "covariance": V6.copy(),
    },
    BaseState: lambda: {
        "stamp_s": 0.0,
        "T_map_base": T.copy(),
        "T_odom_base": T.copy(),
        "T_map_cabin": T.copy(),
        "v_map_cabin": zeros(),
        "w_map_cabin_in_cabin": zeros(),
        "covariance": V6.copy(),
        "status": "GLOBAL",
    },
    Motion: lambda: {
        "stamps_s": [0.0, 1.0],
        "T_map_cabin": np.stack([T, T]),
        "joint_names": ("a",),
        "joint_position": [[0.0], [1.0]],
    },
    Sector: lambda: {
        "centre_map": np.zeros(2),
        "heading_rad": 0.0,
        "angle_rad": 1.0,
        "nearest_m": 1.0,
        "farthest_m": 2.0,
    },
    Cloud: lambda: {"frame": "map", "points": P.copy(), "normals": P.copy()},
    Segment: lambda: {"id": 0, "points": P.copy(), "centroid": zeros(), "extents": zeros()},
    LeftOut: lambda: {
        "kind": PartKind.STACK,
        "reason": "",
        "points": 9,
        "centroid": zeros(),
        "extents": zeros(),
    },
    Segmentation: lambda: {
        "frame": "map",
        "segments": (),
        "ground": Cloud("map", P.copy()),
        "ground_plane": [0, 0, 1, 0],
    },
    Rival: lambda: {
        "T_target_source": np.eye(4),
        "scale": 1.0,
        "likelihood_ratio": 0.5,
    },
    Uncertainty: lambda: {"covariance": np.eye(6), "centre": np.zeros(3)},
    Alignment: lambda: {
        "T_target_source": T.copy(),
        "accepted": True,
        "reason": "",
        "rmse_m": 0.0,
        "overlap": 1.0,
    },
    Stone: lambda: {
        "id": 1,
        "state": StoneState.ON_GROUND,
        "points_map": P.copy(),
        "centroid_map": zeros(),
        "T_map_object": T.copy(),
        "seen_from_above": False,
    },
    StoneEvent: lambda: {
        "stamp_s": 1.0,
        "kind": "found",
        "state": StoneState.ON_GROUND,
        "T_map_object": np.eye(4),
    },
    Grasp: lambda: {"T_map_gripper": T.copy(), "opening_m": 1.0, "score": 0.0, "costs": {}},
    Hold: lambda: {"stone_id": 1, "T_map_gripper": T.copy(), "jaw_rad": 0.2},
    Slot: lambda: {"id": 1, "position_map": zeros()},
    Placement: lambda: {
        "slot": Slot(1, zeros()),
        "T_map_gripper": T.copy(),
        "T_map_object": T.copy(),
    },
    JointTrajectory: lambda: {
        "names": ("a",),
        "times_s": [0.0, 1.0],
        "position": [[0.0], [1.0]],
        "velocity": [[0.0], [0.0]],
    },
    MoveRequest: lambda: {
        "start": np.zeros(7),
        "T_map_gripper": T.copy(),
        "T_map_base": T.copy(),
        "leave_m": 0.0,
        "arrive_m": 0.0,
        "obstacles": Cloud("map", P.copy()),
        "held_gripper": P.copy(),
        "jaw_rad": 0.0,
    },
    PostureRequest: lambda: {
        "start": np.zeros(7),
        "goal": np.zeros(7),
        "T_map_base": T.copy(),
        "obstacles": Cloud("map", P.copy()),
        "held_gripper": P.copy(),
        "jaw_rad": 0.0,
    },
    MotionPlan: lambda: {"trajectory": None, "reason": "", "path_map": P.copy()},
    Mark: lambda: {"text": "here", "position_map": zeros()},
    Region: lambda: {"name": "dump", "corners_map": np.array([[0.0, 0.0], [1, 0], [0, 1]])},
    Row: lambda: {"start_map": np.zeros(2), "heading_rad": 0.0, "gap_m": 0.1},
    Box: lambda: {"centre": np.zeros(2), "length_m": 2.0, "width_m": 1.0, "heading_rad": 0.0},
    Around: lambda: {
        "T_map_base": T.copy(),
        "obstacles": Cloud("map", P.copy()),
        "jaw_rad": 0.0,
    },
    HeightGrid: lambda: {"corner": np.zeros(2), "cell_m": 0.25, "heights": np.zeros((2, 3))},
    GroundBelow: lambda: {
        "corner": np.zeros(2),
        "highest_m": np.zeros((2, 3)),
        "hangs_m": 0.5,
    },
    Structure: lambda: {
        "name": "wall",
        "line": np.array([[0.0, 0.0], [1.0, 0.0]]),
        "thickness_m": 1.0,
        "height_m": 1.0,
    },
    SolidStone: lambda: {
        "name": "corner",
        "vertices": CORNER.copy(),
        "triangles": ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)),  # whole numbers are never NaN
        "mass_kg": 1.0,
    },
    StandingStone: lambda: {
        "stone": SolidStone(**MESSAGES[SolidStone]()),
        "T_map_stone": T.copy(),
    },
    FailedRelease: lambda: {
        "at_map": np.array([1.0, 2.0]),
        "radius_m": 0.4,
        "supports": frozenset({"corner"}),
    },
    BuildTarget: lambda: {
        "stone": "corner",
        "T_map_stone": T.copy(),
        "T_map_settled": T.copy(),
        "approach_map": zeros(),
        "release_height_m": 0.0,
        "worst_m": 0.0,
        "worst_rad": 0.0,
        "score": 0.0,
        "terms": {},
    },
    DriveRequest: lambda: {
        "T_map_base": T.copy(),
        "goals_map": np.zeros((1, 3)),
        "surroundings": Cloud("map", np.zeros((5, 3))),
    },
    BasePath: lambda: {
        "poses_map": np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]),
        "along_m": np.array([0.0, 1.0]),
        "curvature_1_m": np.zeros(2),
        "direction": (1, 1),  # whole numbers are never NaN
    },
}

ARRAYS = [
    (message, name)
    for message, arguments in MESSAGES.items()
    for name, value in arguments().items()
    if isinstance(value, np.ndarray | list)
]
ids = [f"{message.__name__}.{name}" for message, name in ARRAYS]


def test_the_table_covers_every_message_with_arrays() -> None:
    found = set()
    for module in iter_modules(executive.messages.__path__):
        contents = vars(import_module(f"executive.messages.{module.name}")).values()
        found |= {c for c in contents if isinstance(c, type) and hasattr(c, "__dataclass_fields__")}
    with_arrays = {
        c
        for c in found
        if any("Float" in str(f.type) or "float64" in str(f.type) for f in fields(c))
    }
    assert with_arrays - {PackedState} == set(
        MESSAGES
    )  # which is a BaseState made otherwise, by who answers for it


@pytest.mark.parametrize(("message", "name"), ARRAYS, ids=ids)
def test_a_well_formed_message_is_read_only(message: type, name: str) -> None:
    made = message(**MESSAGES[message]())
    with pytest.raises(ValueError, match="read-only"):
        getattr(made, name).flat[0] = 1.0
    with pytest.raises((FrozenInstanceError, AttributeError, TypeError)):
        setattr(made, name, None)


@pytest.mark.parametrize(("message", "name"), ARRAYS, ids=ids)
def test_another_shape_is_refused_by_name(message: type, name: str) -> None:
    arguments = MESSAGES[message]()
    arguments[name] = np.zeros((2, 2, 2))
    with pytest.raises(ShapeError, match=f"^{name} has shape "):
        message(**arguments)


@pytest.mark.parametrize(("message", "name"), ARRAYS, ids=ids)
def test_values_that_are_not_finite_are_refused_by_name(message: type, name: str) -> None:
    arguments = MESSAGES[message]()
    array = np.array(arguments[name], dtype=float)
    array.flat[-1] = np.nan
    arguments[name] = array
    with pytest.raises(ShapeError, match=f"^{name} holds 1 values that are not finite"):
        message(**arguments)


def test_two_arrays_of_one_message_must_be_of_one_length() -> None:
    with pytest.raises(ShapeError, match="velocity"):
        JointSample(0.0, ("a", "b"), [0, 1], [0], [0, 0])
    with pytest.raises(ShapeError, match="point_stamps_s"):
        LidarScan(0.0, "lidar", np.zeros((5, 3)), np.zeros(4))
    with pytest.raises(ShapeError, match="normals"):
        Cloud("map", np.zeros((5, 3)), np.zeros((4, 3)))


def test_stamps_of_a_motion_must_rise() -> None:
    with pytest.raises(DataError, match="rising stamps"):
        Motion([0.0, 0.0], np.stack([T, T]), (), np.zeros((2, 0)))
    with pytest.raises(DataError, match="at least one sample"):
        Motion([], np.zeros((0, 4, 4)), (), np.zeros((0, 0)))


def test_a_trajectory_must_rise_from_zero() -> None:
    for times_s in ([0.1, 1.0], [0.0, 0.0], []):
        n = len(times_s)
        with pytest.raises(ShapeError, match="rise strictly from 0"):
            JointTrajectory(("a",), np.array(times_s), np.zeros((n, 1)), np.zeros((n, 1)))
