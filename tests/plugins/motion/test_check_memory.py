"""Checks of collisions leave nothing behind in the C library's heap."""

import ctypes

import pytest
from executive_plugins.motion.forward_kinematics import link_frames
from executive_plugins.motion.self_collision import SelfCollision, machine_bodies

from executive.machine.machine import load_machine

M545 = load_machine("m545")
ROUNDS = 4
CALLS, MOST_BYTES = 300, 100  # in a round; for a call; 32 bytes for each of 32 bodies were 1,024


class Heap(ctypes.Structure):
    """What mallinfo2(3) returns."""

    _fields_ = [
        *[(f"before_{i}", ctypes.c_size_t) for i in range(7)],
        ("used", ctypes.c_size_t),
        *[(f"after_{i}", ctypes.c_size_t) for i in range(2)],
    ]


def used_bytes() -> int:
    library = ctypes.CDLL(None)
    if not hasattr(library, "mallinfo2"):
        pytest.skip("this C library does not tell what of its heap is used")
    library.mallinfo2.restype = Heap
    return int(library.mallinfo2().used)


def test_a_check_for_each_motion_takes_no_memory_in_the_long_run() -> None:
    bodies = machine_bodies(M545)
    frames = link_frames(M545, M545.posture("carry")[None], 0.3)

    def checked() -> None:
        assert SelfCollision(M545, bodies, 0.05).first_hit(frames) is None
        assert SelfCollision(M545, bodies, 5.0).first_hit(frames) is not None

    for _ in range(20):
        checked()
    grown = []
    for _ in range(ROUNDS):
        before = used_bytes()
        for _ in range(CALLS):
            checked()
        grown.append(used_bytes() - before)
    # Threads of other tests may allocate meanwhile: a leak grows in every round.
    assert min(grown) / CALLS < MOST_BYTES
    assert len(bodies) * 32 > 3 * MOST_BYTES  # so an object a check and body would be noticed
