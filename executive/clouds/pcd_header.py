"""The header of a PCD file, held against the file's size."""

from pathlib import Path

from executive.errors import DataError

_LONGEST_HEADER = 1 << 14


def check_pcd(path: Path) -> None:
    """Refuse a PCD file without coordinates, or shorter than its header says.

    Raises:
        DataError: It names the file, what is wrong and the cure.
    """
    fields, start = _header(path)
    if not {"x", "y", "z"} <= set(fields["FIELDS"]):
        raise DataError(f"{path}: the header names no fields x, y and z; export it as a point cloud")
    body = path.read_bytes()[start:]
    try:
        points = int(fields["POINTS"][0])
        sizes = [int(size) for size in fields["SIZE"]]
        counts = [int(count) for count in fields.get("COUNT", ["1"] * len(sizes))]
        point_bytes = sum(size * count for size, count in zip(sizes, counts, strict=True))
        have, want, what = _sizes(fields["DATA"][0], body, (points * sum(counts), points * point_bytes))
    except (IndexError, ValueError) as error:
        raise DataError(f"{path}: the PCD header cannot be understood ({error}); export it again") from error
    if have < want:
        raise DataError(
            f"{path}: cut short: the header promises {points} points ({want} {what}), the file has {have} {what}; "
            "copy or export it again"
        )


def _sizes(data: str, body: bytes, wanted: tuple[int, int]) -> tuple[int, int, str]:
    """Return how much there is, how much there must be, and the unit; wanted are numbers (ASCII) and bytes."""
    if data == "ascii":
        return len(body.split()), wanted[0], "numbers"
    if data == "binary":
        return len(body), wanted[1], "bytes"
    if data == "binary_compressed":
        return len(body), 8 + int.from_bytes(body[:4], "little"), "bytes"  # two lengths, then the compressed points
    raise ValueError(f"unknown DATA {data}")


def _header(path: Path) -> tuple[dict[str, list[str]], int]:
    with path.open("rb") as file:
        beginning = file.read(_LONGEST_HEADER)
    start = beginning.find(b"\nDATA ")
    stop = beginning.find(b"\n", start + 1)
    lines = beginning[:stop].decode("ascii", errors="replace").splitlines()
    fields = {words[0]: words[1:] for line in lines if (words := line.split()) and not words[0].startswith("#")}
    if start < 0 or stop < 0 or not {"FIELDS", "SIZE", "POINTS", "DATA"} <= set(fields):
        raise DataError(f"{path}: no PCD file: it lacks a header with FIELDS, SIZE, POINTS and DATA; export it again")
    return fields, stop + 1
