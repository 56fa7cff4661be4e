"""Colour and intensity of a file are known by names and types, and carried value by value."""

from pathlib import Path

import numpy as np
import pytest

from executive.clouds.carried_fields import CarriedFields, left_out
from executive.clouds.file_cloud import FileCloud, Place
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy

PATH = Path("a.ply")
PLACES = [("x", "f4"), ("y", "f4"), ("z", "f4")]


def of(*fields: tuple[str, ...]) -> CarriedFields:
    return CarriedFields.of(np.dtype([*PLACES, *fields]))  # type: ignore[arg-type]


def rgb(kind: str, *names: str) -> list[tuple[str, str]]:
    return [(name, kind) for name in names or ("red", "green", "blue")]


@pytest.mark.parametrize(
    ("fields", "found"),
    [
        ([], CarriedFields()),
        (rgb("u1"), CarriedFields(("red", "green", "blue"))),
        (rgb("u2", "Red", "GREEN", "blue"), CarriedFields(("Red", "GREEN", "blue"), "u2")),
        (
            rgb("u1", "diffuse_red", "diffuse_green", "diffuse_blue"),
            CarriedFields(("diffuse_red", "diffuse_green", "diffuse_blue")),
        ),
        (rgb("u1", "red", "green"), CarriedFields()),
        (rgb("f4"), CarriedFields()),
        ([("red", "u1"), ("green", "u1"), ("blue", "u2")], CarriedFields()),
        ([("rgb", "u4")], CarriedFields(("rgb",))),
        ([("rgba", "i4")], CarriedFields(("rgba",))),
        ([("rgb", "f4")], CarriedFields(("rgb",), is_float=True)),
        ([("rgb", "u2")], CarriedFields()),
        ([*rgb("u1"), ("rgb", "u4")], CarriedFields(("red", "green", "blue"))),
        ([("Intensity", "u2")], CarriedFields(intensity="Intensity")),
        ([("scalar_Intensity", "f4")], CarriedFields(intensity="scalar_Intensity")),
        (
            [("scalar_intensity", "f4"), ("intensity", "f4")],
            CarriedFields(intensity="intensity"),
        ),
        ([("intensity", "f4", (2,))], CarriedFields()),  # a list for each point
    ],
)
def test_fields_are_known_by_their_names_and_types(fields: list, found: CarriedFields) -> None:
    assert of(*fields) == found


def test_what_is_neither_a_coordinate_nor_carried_is_left_out() -> None:
    carried = CarriedFields(("rgb",), intensity="i")
    assert left_out(("x", "y", "z", "rgb", "i", "time"), carried) == ("time",)
    assert carried.names == ("rgb", "i")
    assert carried.layout == np.dtype([("colour", "u1", (3,)), ("intensity", "<f4")])
    assert CarriedFields().layout == np.dtype([])


@pytest.mark.parametrize(("depth", "most"), [("u1", 255), ("u2", 65535)])
def test_channels_are_within_their_depth(depth: str, most: int) -> None:
    carried = CarriedFields(("r", "g", "b"), depth)
    source = {"r": np.array([0, 1]), "g": np.array([2, most]), "b": np.array([3, 4])}
    rows = carried.rows(PATH, source)
    assert rows["colour"].tolist() == [[0, 2, 3], [1, most, 4]]
    for wrong in (-1, most + 1, np.nan):
        with pytest.raises(DataError, match=f"a value of 'g' is not within 0 to {most}; export"):
            carried.rows(PATH, {**source, "g": np.array([2.0, wrong])})


def test_one_number_holds_three_channels_whatever_it_is_called() -> None:
    whole = np.array([0x00102030, 0xFFFEFDFC], dtype=np.uint32)
    expected = [[0x10, 0x20, 0x30], [0xFE, 0xFD, 0xFC]]
    for values in (whole, whole.view(np.int32), whole.astype(np.int64).astype(np.uint32)):
        assert CarriedFields(("rgb",)).rows(PATH, {"rgb": values})["colour"].tolist() == expected
    bits = np.array([0x00102030], dtype=np.uint32).view(np.float32)
    found = CarriedFields(("rgb",), is_float=True).rows(PATH, {"rgb": bits.astype(float)})
    assert found["colour"].tolist() == expected[:1]
    with pytest.raises(DataError, match="a value of 'rgb' is not within 0 to 4294967295"):
        CarriedFields(("rgb",)).rows(PATH, {"rgb": np.array([-1.0])})


def test_intensities_are_carried_though_they_are_not_finite() -> None:
    rows = CarriedFields(intensity="i").rows(PATH, {"i": np.array([0.5, np.inf, np.nan, 1e300])})
    np.testing.assert_array_equal(rows["intensity"], np.float32([0.5, np.inf, np.nan, np.inf]))


def cloud(colour: np.ndarray | None = None) -> FileCloud:
    points = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]])
    return FileCloud(points, colour, np.array([0.5, 0.7], np.float32), Place("EPSG:2056"), ("t",))


def test_a_part_of_a_cloud_keeps_what_belongs_to_its_points() -> None:
    part = cloud(np.array([[1, 2, 3], [4, 5, 6]], np.uint8)).only(np.array([False, True]))
    assert part.colour is not None
    assert part.intensity is not None
    assert (part.points.tolist(), part.colour.tolist()) == ([[0.0, 2.0, 0.0]], [[4, 5, 6]])
    assert part.intensity.tolist() == [np.float32(0.7)]
    assert (part.place.crs, part.left_out, len(part)) == ("EPSG:2056", ("t",), 1)
    bare = FileCloud(cloud().points).only(np.array([1]))
    assert (bare.colour, bare.intensity) == (None, None)


def test_a_cloud_is_scaled_turned_and_shifted_into_another_frame() -> None:
    moved = cloud().moved(pose(from_rpy(0, 0, np.pi / 2), np.array([10.0, 0.0, 0.0])), 2.0, "other")
    np.testing.assert_allclose(moved.points, [[10.0, 2.0, 0.0], [6.0, 0.0, 0.0]], atol=1e-12)
    assert moved.place == Place("other")


@pytest.mark.parametrize(
    ("colour", "kept", "told"),
    [
        (np.array([[1, 255, 3]], np.uint8), [[1, 255, 3]], ()),
        (np.array([[1, 255, 3]], np.uint16), [[1, 255, 3]], ()),  # 8 bits in 16
        (np.array([[0x100, 0xFFFF, 3]], np.uint16), [[1, 255, 0]], ("colours of 16 bits are cut",)),
        (np.array([[257, 257 * 9, 0]], np.uint16), [[1, 9, 0]], ()),  # 8 bits stretched to 16
    ],
)
def test_colours_of_sixteen_bits_are_cut_to_eight(
    colour: np.ndarray, kept: list[list[int]], told: tuple[str, ...]
) -> None:
    found = cloud(colour)
    assert found.colour_8().dtype == np.uint8
    assert found.colour_8().tolist() == kept
    assert [one.startswith(told[0]) for one in found.rounding_to_8()] == [True] * len(told)


def test_a_cloud_without_colour_has_none_to_cut() -> None:
    assert cloud().rounding_to_8() == ()
    with pytest.raises(ValueError, match="the cloud has no colour"):
        cloud().colour_8()


def test_a_cloud_is_made_of_what_was_carried() -> None:
    rows = np.zeros(2, np.dtype([("colour", "u1", (3,)), ("intensity", "<f4")]))
    points = cloud().points
    whole = FileCloud.of(points, rows, ("t",))
    assert whole.colour is not None
    assert whole.intensity is not None
    assert (whole.colour.shape, whole.intensity.shape, whole.left_out) == ((2, 3), (2,), ("t",))
    bare = FileCloud.of(points, None, ())
    assert (bare.colour, bare.intensity) == (None, None)
    half = FileCloud.of(points, np.zeros(2, np.dtype([("intensity", "<f4")])), ())
    assert half.colour is None
    assert half.intensity is not None
