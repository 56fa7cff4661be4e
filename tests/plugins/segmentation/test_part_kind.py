"""What a part is told to be, on boxes and grids of known size, at the bounds of each limit."""

import numpy as np
import pytest
from executive_plugins.segmentation import part_kind
from executive_plugins.segmentation.limits import Limits
from executive_plugins.segmentation.part_kind import PartJudge, left_out
from executive_plugins.segmentation.seen_ground import SeenGround

from executive.arrays import Float
from executive.messages.segment import PartKind

LIMITS = Limits(
    voxel_m=0.05,
    fine_voxel_m=0.02,
    cell_m=0.05,
    patch_m=0.1,
    least_points=10,
    least_extent_m=0.4,
    least_height_m=0.2,
    most_extent_m=2.0,
    most_width_m=0.9,
    heap_m=8.0,
)
HOLLOW = 0.2  # what one stone may have; half as much again is asked of a part


def judge(tops: int = 1, below: Float | None = None) -> PartJudge:
    places = np.empty((0, 2)) if below is None else below
    level = np.column_stack([places, np.zeros(len(places))])
    ground = SeenGround(level, np.zeros(3), np.eye(3)[:, :2], 0.05)
    return PartJudge(LIMITS, HOLLOW, 0.02, 0.6, lambda places, heights: tops, ground)


def box(length_m: float, width_m: float, height_m: float) -> Float:
    """Return an even grid on all sides of a box on the ground, corners included."""
    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, 13)] * 3, indexing="ij"), axis=-1)
    points = grid.reshape(-1, 3)
    is_side = ((points == 0) | (points == 1)).any(axis=1)
    return points[is_side] * [length_m, width_m, height_m]


def told(part: Float, tops: int = 1, heights: Float | None = None) -> tuple[PartKind, str] | None:
    up = part[:, 2] if heights is None else heights
    return judge(tops).fault(part, part[:, :2], up, np.random.default_rng(0))


def test_a_box_of_a_stone_s_size_is_one() -> None:
    assert told(box(1.0, 0.8, 0.6)) is None


def test_what_is_low_or_short_is_too_small() -> None:
    assert told(box(0.8, 0.6, 0.2)) is None
    assert told(box(0.8, 0.6, 0.19)) == (PartKind.TOO_SMALL, "0.19 m high, less than 0.20 m")
    assert told(box(0.401, 0.3, 0.25)) is None
    assert told(box(0.39, 0.3, 0.25)) == (PartKind.TOO_SMALL, "0.39 m long, less than 0.40 m")
    # Its height is above the ground, wherever that is.
    high = box(0.8, 0.6, 0.1) + [0.0, 0.0, 0.5]
    assert told(high) is None
    assert told(high, heights=high[:, 2] - 0.5) == (
        PartKind.TOO_SMALL,
        "0.10 m high, less than 0.20 m",
    )


def test_what_is_mostly_one_plane_is_built() -> None:
    wall = np.array([[0.1 * i, 0.0, 0.1 * j] for i in range(10) for j in range(10)])
    flat = told(wall)
    assert flat == (PartKind.STRUCTURE, "100% of its points are on one plane")
    within = wall + [0.0, 0.015, 0.0] * (np.arange(100) % 2)[:, None]
    assert told(within)[0] is PartKind.STRUCTURE
    rng = np.random.default_rng(1)
    rough = wall + rng.uniform(-0.2, 0.2, (100, 3))
    assert told(rough) is None


@pytest.mark.parametrize(("on_plane", "is_flat"), [(299, False), (300, True)])
def test_a_plane_counts_from_its_share_on(
    monkeypatch: pytest.MonkeyPatch, on_plane: int, is_flat: bool
) -> None:
    """Three in five of a sample of five hundred, however many points there are."""
    sizes = []

    def counts(sample: Float, planes: Float, margin_m: float) -> np.ndarray:
        sizes.append(len(sample))
        assert margin_m == 0.02
        assert planes.shape[1] == 4
        return np.array([3, on_plane, 7])

    monkeypatch.setattr(part_kind, "counts_near", counts)
    found = told(np.vstack([box(1.0, 0.8, 0.6)] * 2))
    assert found == (
        (PartKind.STRUCTURE, "60% of its points are on one plane") if is_flat else None
    )
    assert sizes == [500]


def test_points_on_one_line_are_nothing_known() -> None:
    line = np.linspace(0, 1, 50)[:, None] * [0.6, 0.0, 0.5]
    assert told(line) == (PartKind.UNKNOWN, "its points span no plane")


def test_what_stands_upright_is_built() -> None:
    """More than twice as high as its larger side on the ground."""
    assert told(box(0.5, 0.4, 0.99)) is None
    assert told(box(0.5, 0.4, 1.02)) == (
        PartKind.STRUCTURE,
        "stands upright: 1.02 m high, 0.50 m wide",
    )


@pytest.mark.parametrize(
    ("gap_m", "share", "hangs"), [(0.61, 0.55, True), (0.59, 0.55, False), (0.61, 0.45, False)]
)
def test_what_has_ground_below_it_and_a_gap_as_high_as_itself_hangs(
    gap_m: float, share: float, hangs: bool
) -> None:
    part, rng = box(1.0, 0.8, 0.6), np.random.default_rng(0)
    below = rng.uniform(0, 1, (20_000, 2)) * [share, 0.81]
    found = judge(below=below).hanging(part[:, :2], part[:, 2] + gap_m)
    if hangs:
        assert found is not None
        assert found[0] is PartKind.STRUCTURE
        assert found[1].startswith("hangs 0.61 m above the ground, which is seen below 5")
    else:
        assert found is None


def test_what_is_long_is_too_large_or_several() -> None:
    assert told(box(1.999, 0.8, 0.6)) is None
    long = box(2.01, 0.8, 0.6)
    assert told(long) == (PartKind.TOO_LARGE, "2.01 m long, more than 2.00 m")
    assert told(long, tops=2) == (
        PartKind.STACK,
        "2.01 m long, more than 2.00 m, with 2 tops that could not be parted",
    )


def test_what_is_wide_in_all_directions_is_too_large_for_the_jaws() -> None:
    assert told(box(1.5, 1.2, 0.89)) is None
    assert told(box(1.5, 1.2, 0.91), tops=3) == (
        PartKind.TOO_LARGE,
        "0.91 m wide, more than the jaws' opening of 0.90 m",
    )


@pytest.mark.parametrize(
    ("share", "tops", "is_stack"), [(0.31, 2, True), (0.31, 1, False), (0.29, 2, False)]
)
def test_what_is_hollow_and_has_tops_is_several(
    monkeypatch: pytest.MonkeyPatch, share: float, tops: int, is_stack: bool
) -> None:
    """One stone with a deep hollow remains one."""
    monkeypatch.setattr(part_kind, "hollow_share", lambda part: share)
    monkeypatch.setattr(part_kind, "is_hollow", lambda part, most, longest_m: share > most)
    reason = "hollow by 31% of its length, one stone by at most 30%"
    assert told(box(1.0, 0.8, 0.6), tops) == ((PartKind.STACK, reason) if is_stack else None)


def test_a_cluster_wider_than_any_heap_is_built() -> None:
    for axis in range(3):
        for width_m, is_wide in ((8.0, False), (8.1, True)):
            points = np.zeros((2, 3))
            points[1, axis] = width_m
            found = judge().wide(points)
            expected = PartKind.STRUCTURE, "8.1 m wide, more than any heap (8 m)"
            assert found == (expected if is_wide else None)


BUILT, FLAT = (PartKind.STACK, "a stack"), (PartKind.STRUCTURE, "flat")
LARGE, SMALL = (PartKind.TOO_LARGE, "large"), (PartKind.TOO_SMALL, "small")


@pytest.mark.parametrize(
    ("sizes", "faults", "reason"),
    [
        ((10, 20), (BUILT, None), None),  # no more than a third
        ((11, 20), (BUILT, None), "1 of its 2 parts, 35% of its points"),
        ((11, 20), (SMALL, None), None),
        ((5, 6, 20), (FLAT, LARGE, None), "2 of its 3 parts, 35% of its points"),
        ((5, 6, 20), (FLAT, SMALL, None), None),
        ((30,), (FLAT,), None),  # it is told by itself
        ((30, 30), (FLAT, FLAT), "2 of its 2 parts, 100% of its points"),
    ],
)
def test_a_cluster_that_is_built_by_a_third_is_so_as_a_whole(sizes, faults, reason) -> None:
    parts = [np.arange(size) for size in sizes]
    told_why = f"{reason}, are flat, upright, too large or stacks"
    expected = None if reason is None else (PartKind.STRUCTURE, told_why)
    assert judge().whole(parts, faults) == expected


def test_what_is_left_out_is_told_with_its_place_and_size() -> None:
    points = box(1.0, 0.8, 0.6)
    one = left_out(points, PartKind.TOO_LARGE, "why", np.array([10.0, 20.0, 30.0]))
    assert (one.kind, one.reason, one.points) == (PartKind.TOO_LARGE, "why", len(points))
    assert one.centroid == pytest.approx([10.5, 20.4, 30.3])
    assert one.extents == pytest.approx([1.0, 0.8, 0.6])
