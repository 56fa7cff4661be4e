"""LAS and LAZ files: scale and offset, units by the file's own word, and damage of every kind."""

import struct
from pathlib import Path

import laspy
import lazrs
import numpy as np
import pytest

from executive.clouds.reader import read_points
from executive.errors import DataError

OFFSET = np.array([412_000.0, 5_246_000.0, 440.0])
POINTS = np.round(np.random.default_rng(0).uniform(0, 10, (1000, 3)), 3) + OFFSET


def las(path: Path, version: str = "1.2", point_format: int = 3) -> Path:
    header = laspy.LasHeader(point_format=point_format, version=version)
    header.scales, header.offsets = np.full(3, 0.001), OFFSET
    data = laspy.LasData(header)
    data.xyz = POINTS
    data.classification = np.arange(1000) % 3
    data.write(path)
    return path


def declare(path: Path, key: int, value: int) -> Path:
    """Add a GeoTIFF key to a file."""
    data = laspy.read(path)
    record = laspy.VLR(
        "LASF_Projection", 34735, record_data=struct.pack("<8H", 1, 1, 0, 1, key, 0, 1, value)
    )
    data.header.vlrs.append(record)
    data.write(path)
    return path


@pytest.mark.parametrize("suffix", ["las", "laz"])
@pytest.mark.parametrize(
    ("version", "point_format"), [("1.2", 0), ("1.2", 3), ("1.4", 6), ("1.4", 7)]
)
def test_national_coordinates_are_read_to_the_files_own_millimetre(
    tmp_path: Path, suffix: str, version: str, point_format: int
) -> None:
    # 1 µm: doubles have 1 nm left at 5,246 km.
    assert np.allclose(
        read_points(las(tmp_path / f"site.{suffix}", version, point_format)),
        POINTS,
        atol=1e-6,
        rtol=0,
    )


@pytest.mark.parametrize("suffix", ["las", "laz"])
def test_records_behind_the_points_are_read_over_and_false_ones_refused(
    tmp_path: Path, suffix: str
) -> None:
    path = las(tmp_path / f"site.{suffix}", "1.4", 6)
    data = laspy.read(path)
    data.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("someone", 7, record_data=b"x" * 10)])
    data.write(path)
    assert len(read_points(path)) == len(POINTS)
    content = path.read_bytes()
    start, count = struct.unpack_from("<QI", content, 235)
    for place, number, told in (
        (len(content) + 1, count, f"promises 1 records from byte {len(content) + 1} on"),
        (start, 2, f"promises 2 records from byte {start} on"),
    ):
        path.write_bytes(content[:235] + struct.pack("<QI", place, number) + content[247:])
        with pytest.raises(DataError, match=told):
            read_points(path)
    path.write_bytes(content[: start + 20] + struct.pack("<Q", 11) + content[start + 28 :])
    with pytest.raises(DataError, match=f"behind the points ends at byte {len(content) + 1}"):
        read_points(path)


@pytest.mark.parametrize("suffix", ["las", "laz"])
@pytest.mark.parametrize("share", [0.01, 0.1, 0.5, 0.99])
def test_a_file_cut_short_is_refused(tmp_path: Path, suffix: str, share: float) -> None:
    path = las(tmp_path / f"site.{suffix}")
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(DataError, match=rf"site\.{suffix}: cut short.*copy or export it again"):
        read_points(path)


@pytest.mark.parametrize("suffix", ["las", "laz"])
def test_a_claim_of_billions_of_points_is_refused(tmp_path: Path, suffix: str) -> None:
    path = las(tmp_path / f"site.{suffix}")
    content = bytearray(path.read_bytes())
    struct.pack_into("<I", content, 107, 4_000_000_000)
    path.write_bytes(content)
    with pytest.raises(DataError, match=r"cut short|4000000000 points are more than 5e"):
        read_points(path)


def test_points_out_of_the_headers_box_are_refused(tmp_path: Path) -> None:
    path = las(tmp_path / "site.las")
    content = bytearray(path.read_bytes())
    start = struct.unpack_from("<I", content, 96)[0]
    struct.pack_into("<i", content, start, 2_000_000)  # x of the first point: 2 km from the others
    path.write_bytes(content)
    with pytest.raises(DataError, match="outside the bounding box in its header"):
        read_points(path)


def test_a_scale_of_nothing_is_refused(tmp_path: Path) -> None:
    path = las(tmp_path / "site.las")
    content = bytearray(path.read_bytes())
    struct.pack_into("<d", content, 131, float("nan"))
    path.write_bytes(content)
    with pytest.raises(DataError, match=r"the scale .* is invalid"):
        read_points(path)


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("suffix", ["las", "laz"])
def test_damage_is_an_error_or_is_read_but_never_crashes(
    tmp_path: Path, suffix: str, seed: int
) -> None:
    path = las(tmp_path / f"site.{suffix}")
    content, rng = bytearray(path.read_bytes()), np.random.default_rng(seed)
    for place in rng.integers(0, 400 if seed % 2 else len(content), 4):
        content[place] = rng.integers(0, 256)
    path.write_bytes(content)
    try:
        assert np.isfinite(read_points(path)).all()
    except DataError as refusal:
        assert path.name in str(refusal)  # noqa: PT017 - either way is right


@pytest.mark.parametrize(
    ("key", "value", "unit"),
    [(3076, 9002, "feet"), (3076, 9003, "US survey feet"), (1024, 2, "degrees")],
)
def test_another_unit_is_named(tmp_path: Path, key: int, value: int, unit: str) -> None:
    path = declare(las(tmp_path / "site.las"), key, value)
    with pytest.raises(
        DataError, match=f"its header says that coordinates are in {unit}; project it to metres"
    ):
        read_points(path)


def test_the_metre_may_be_named(tmp_path: Path) -> None:
    assert len(read_points(declare(las(tmp_path / "site.las"), 3076, 9001))) == 1000


def changed(path: Path, at: int, kind: str, value: int) -> Path:
    content = bytearray(path.read_bytes())
    struct.pack_into(kind, content, at, value)
    path.write_bytes(content)
    return path


def test_a_table_of_chunks_that_would_take_gigabytes_is_refused(tmp_path: Path) -> None:
    path = las(tmp_path / "site.laz")
    content = path.read_bytes()
    (table,) = struct.unpack_from("<q", content, struct.unpack_from("<I", content, 96)[0])
    changed(path, table + 4, "<I", 0x60000000)
    with pytest.raises(DataError, match=r"site\.laz: .*it promises 1610612736 chunks in \d+ bytes"):
        read_points(path)


@pytest.mark.parametrize(
    ("suffix", "version", "at", "kind", "value", "words"),
    [
        ("las", "1.2", 100, "<I", 0xFFFFFFFF, "promises 4294967295 records before byte"),
        ("las", "1.2", 96, "<I", 0xFFFFFFF, "points from byte 268435455"),
        ("las", "1.2", 105, "<H", 3, "shorter than those of any LAS format"),
        ("las", "1.4", 243, "<I", 0xFFFFFFFF, "promises 4294967295 records from byte"),
        ("las", "1.4", 94, "<H", 230, "a LAS 1.4 header has 375 bytes"),
        ("laz", "1.2", 230, "<B", 65, "no record says how"),
    ],
)
def test_a_header_that_promises_what_the_file_cannot_hold_is_refused(
    tmp_path: Path, suffix: str, version: str, at: int, kind: str, value: int, words: str
) -> None:
    good = las(tmp_path / f"site.{suffix}", version, 7 if version == "1.4" else 3)
    path = changed(good, at, kind, value)
    with pytest.raises(DataError, match=rf"site\.{suffix}: .*{words}"):
        read_points(path)


def test_chunks_of_any_size_are_read_as_in_copc(tmp_path: Path) -> None:
    """A file of Cloud Optimized Point Clouds is LAZ 1.4 with a chunk for each node of its tree."""
    plain = las(tmp_path / "site.las", "1.4", 6).read_bytes()
    (start,), size = struct.unpack_from("<I", plain, 96), laspy.PointFormat(6).size
    rows = np.frombuffer(plain[start : start + size * len(POINTS)], dtype=np.uint8)
    packing = lazrs.LazVlr.new_for_compression(6, 0, True)
    records = b"".join(
        struct.pack("<H16sHH32s", 0, name, number, len(content), b"") + content
        for name, number, content in (
            (b"copc", 1, bytes(160)),
            (b"laszip encoded", 22204, bytes(packing.record_data())),
        )
    )
    head = bytearray(plain[:375] + records)
    struct.pack_into("<HII", head, 94, 375, len(head), 2)
    head[104] |= 0x80
    with (tmp_path / "site.copc.laz").open("w+b") as file:
        file.write(head)
        packer = lazrs.LasZipCompressor(file, packing)
        for begun, ended in ((0, 130), (130, 700), (700, 1000)):
            packer.compress_many(rows[begun * size : ended * size])
            if ended < len(POINTS):
                packer.finish_current_chunk()
        packer.done()
    found = read_points(tmp_path / "site.copc.laz")
    assert np.allclose(found, POINTS, atol=1e-6, rtol=0)  # as for other files
