"""What is packed is what arrives, however it is cut on the way; anything else is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.errors import ConfigError
from executive.messages.command import Follow, LimitStop, MoveJaws, SwitchLidars
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.trajectory import JointTrajectory
from executive.wire.address import Address
from executive.wire.frame import Frame, FrameReader, Kind, WireError
from executive.wire.payload import pack, unpack

RNG = np.random.default_rng(3)
MESSAGES = [
    ImuSample(1.5, "imu_cabin", RNG.normal(size=3), RNG.normal(size=3)),
    GnssFix(2.5, "gnss_left", np.array([47.0, 8.0, 440.0]), np.eye(3), True),
    JointSample(3.5, ("a", "b"), RNG.normal(size=2), RNG.normal(size=2), RNG.normal(size=2)),
    LidarScan(4.5, "lidar", RNG.normal(size=(7, 3)), np.linspace(4.4, 4.5, 7)),
    LidarScan(4.5, "lidar", np.empty((0, 3)), np.empty(0)),
    MoveJaws(0.3, 8000.0),
    SwitchLidars(False),
    LimitStop(1.25),
    Follow(JointTrajectory(("a",), np.array([0.0, 1.0]), np.zeros((2, 1)), np.zeros((2, 1)))),
]


def fields_of(value):
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    if hasattr(value, "__dataclass_fields__"):
        return [fields_of(getattr(value, name)) for name in value.__dataclass_fields__]
    return value


def test_messages_come_back_bit_for_bit():
    objects, body = pack(MESSAGES)
    back = unpack(objects, body)
    assert [type(one) for one in back] == [type(one) for one in MESSAGES]
    assert [fields_of(one) for one in back] == [fields_of(one) for one in MESSAGES]


def test_stamps_are_those_of_the_mission():
    objects, body = pack(MESSAGES[:4])
    back = unpack(objects, body, 1.0)
    assert [one.stamp_s for one in back] == [0.5, 1.5, 2.5, 3.5]
    np.testing.assert_allclose(back[3].point_stamps_s, MESSAGES[3].point_stamps_s - 1.0)


@given(st.lists(st.integers(1, 200), min_size=1, max_size=30))
@settings(max_examples=50)
def test_frames_are_put_together_however_they_are_cut(cuts):
    frames = [Frame(Kind.STATUS, {"n": n}, bytes(n), n) for n in range(20)]
    data = b"".join(frame.packed() for frame in frames)
    reader, found = FrameReader(), []
    while data:
        size = cuts[len(data) % len(cuts)]
        found += reader.feed(data[:size])
        data = data[size:]
    assert found == frames


@given(st.binary(min_size=16, max_size=200))
@settings(max_examples=300)
def test_bytes_that_are_no_frame_are_refused(data):
    with pytest.raises(WireError):
        list(FrameReader().feed(b"NOPE" + data))


@given(st.integers(0, 60), st.binary(min_size=1, max_size=3))
@settings(max_examples=500)
def test_a_damaged_frame_is_refused_or_waited_for(position, damage):
    data = bytearray(Frame(Kind.COMMAND, {"commands": []}, b"12345678", 7).packed())
    data[position : position + len(damage)] = damage
    try:
        frames = list(FrameReader().feed(bytes(data)))
    except WireError:
        return
    assert len(frames) <= 1


@pytest.mark.parametrize(
    ("objects", "body"),
    [
        ({}, b""),
        ([{"type": "Nonsense"}], b""),
        ([{"type": "ImuSample", "stamp_s": 1.0}], b""),
        ([7], b""),
        ([], b"123"),
        ([{"type": "MoveJaws", "position_rad": {"shape": [9]}, "force_n": 1.0}], b""),
        ([{"type": "MoveJaws", "position_rad": {"shape": [-1]}, "force_n": 1.0}], b""),
        ([{"type": "JointSample", "stamp_s": 1.0, "names": ["a"]}], b""),
    ],
)
def test_what_is_no_message_is_refused(objects, body):
    with pytest.raises(WireError):
        unpack(objects, body)


@pytest.mark.parametrize(
    "text", ["0.0.0.0:4600", "192.168.0.4:1", "machine", "unix:", ":1", "127.0.0.1:x"]
)
def test_the_wire_stays_on_this_computer(text):
    with pytest.raises(ConfigError, match=r"unix:PATH or 127.0.0.1:PORT"):
        Address.parse(text)
