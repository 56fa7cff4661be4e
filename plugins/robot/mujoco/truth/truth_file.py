"""The truth of a simulated run as a file: left by one process, read by the oracle of another."""

import os
from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from executive_plugins.robot.mujoco.truth.contact_log import Span
from numpy.typing import NDArray

from executive.arrays import Float
from executive.errors import DataError

Records = dict[str, NDArray[np.generic]]
Rests = list[list[tuple[float, Float]]]

_SPAN_FORM = [("link", "U64"), ("other", "U64"), ("from_s", "f8"), ("to_s", "f8"), ("force", "f8")]


def write_records(path: Path, records: Records) -> None:
    """Write arrays by name, whole or not at all.

    Raises:
        OSError: If the file cannot be written.
    """
    partial = path.with_suffix(".partial")
    with partial.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **records)
        file.flush()
        os.fsync(file.fileno())
    partial.replace(path)


def read_records(path: Path) -> Records:
    """Return the arrays of a file.

    Raises:
        DataError: If it is missing or damaged.
    """
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as found:
            return {name: found[name] for name in found.files}
    except (OSError, ValueError, EOFError, BadZipFile) as error:
        raise DataError(f"{path}: the truth of the run cannot be read: {error}") from error


def rests_as_arrays(rests: Rests) -> Records:
    """Return which stone lay somewhere, (R,), since when [s], (R,), and its poses, (R, 4, 4)."""
    flat = [(i, since_s, T) for i, several in enumerate(rests) for since_s, T in several]
    return {
        "rest_stones": np.array([i for i, _, _ in flat], dtype=int),
        "rest_since_s": np.array([since_s for _, since_s, _ in flat]),
        "rest_poses": np.array([T for _, _, T in flat]).reshape(-1, 4, 4),
    }


def rests_from(records: Records, stones: int, zero_s: float) -> Rests:
    """Return where each stone came to rest, by the stone; times count from `zero_s`."""
    found: Rests = [[] for _ in range(stones)]
    columns = (records[name] for name in ("rest_stones", "rest_since_s", "rest_poses"))
    for i, since_s, T in zip(*columns, strict=True):
        found[int(i)].append((float(since_s) - zero_s, np.asarray(T, dtype=np.float64)))
    return found


def spans_as_array(spans: Sequence[Span]) -> NDArray[np.generic]:
    """Return contacts as one array of records."""
    return np.array([astuple(span) for span in spans], dtype=_SPAN_FORM)


def spans_from(array: NDArray[np.generic], zero_s: float) -> list[Span]:
    """Return the contacts of `spans_as_array`; times count from `zero_s`."""
    return [
        Span(str(link), str(other), float(from_s) - zero_s, float(to_s) - zero_s, float(force))
        for link, other, from_s, to_s, force in array.tolist()
    ]
