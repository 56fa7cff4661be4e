"""A database that is written when the process is killed, or while others read it, stays whole."""

import os
import signal
import sqlite3
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.errors import ConfigError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.segment import Segment
from executive.messages.stone import StoneState

KILLS = 30


def opened(path: Path, read_only: bool = False) -> SqliteObjects:
    database = SqliteObjects(SqliteObjectsSettings())
    database.open(str(path), read_only)
    return database


def found(path: Path) -> None:
    points = np.random.default_rng(0).uniform(-0.4, 0.4, (2000, 3))
    with closing(opened(path)) as database:
        for i in range(3):
            database.observe(
                [Segment(0, points + [3 * i, 0, 0], np.array([3.0 * i, 0, 0]), np.ones(3))],
                0.0,
                True,
            )


def write_for_ever(path: Path, report: int) -> None:
    """Move stones about, and send a byte after each change that has returned."""
    rng, database = np.random.default_rng(os.getpid()), opened(path)
    while True:
        stone = database.stone(int(rng.integers(1, 4)))
        T = pose(from_rpy(*rng.uniform(-1, 1, 3)), rng.uniform(-5, 5, 3))
        if stone.state is StoneState.HELD:
            database.release(stone.id, T, 1.0, StoneState.PLACED)
        elif rng.random() < 0.5:
            database.grasp(stone.id, T, 1.0)
        else:
            here = Segment(0, stone.points_map, stone.centroid_map, np.ones(3))
            database.observe([here], 1.0, False)
        os.write(report, b".")


def forked(work: Callable[[], None]) -> int:
    child = os.fork()
    if child == 0:
        try:
            work()
        finally:
            os._exit(1)
    return child


def count_of(path: Path) -> int:
    with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as connection:
        return int(connection.execute("SELECT count(*) FROM events").fetchone()[0])


def check_whole(path: Path) -> None:
    """Each stone is as its newest event says: a change is in both tables or in neither."""
    with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
    with closing(opened(path, read_only=True)) as database:
        for stone in database.stones():
            newest = database.history(stone.id)[-1]
            assert stone.state is newest.state
            np.testing.assert_array_equal(stone.T_map_object, newest.T_map_object)


def test_a_kill_at_any_moment_loses_no_change_that_returned(tmp_path: Path) -> None:
    path, rng = tmp_path / "objects.sqlite", np.random.default_rng(0)
    found(path)
    total = 0
    for _ in range(KILLS):
        before = count_of(path)
        ends = os.pipe()
        child = forked(lambda ends=ends: write_for_ever(path, ends[1]))
        os.close(ends[1])
        os.read(ends[0], 1)  # it is at work
        time.sleep(rng.uniform(0.0, 0.05))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        returned = 1
        while more := os.read(ends[0], 65536):
            returned += len(more)
        os.close(ends[0])
        # At most one more: it was committed, and the kill came before the call returned.
        assert count_of(path) - before - returned in (0, 1)
        check_whole(path)
        total += returned
    assert total > KILLS


def test_it_is_read_while_a_mission_writes(tmp_path: Path) -> None:
    path = tmp_path / "objects.sqlite"
    found(path)
    ends = os.pipe()
    child = forked(lambda: write_for_ever(path, ends[1]))
    os.close(ends[1])
    try:
        counts = []
        with closing(opened(path, read_only=True)) as reader:
            for _ in range(20):
                os.read(ends[0], 1)
                assert [stone.id for stone in reader.stones()] == [1, 2, 3]
                counts.append(sum(len(reader.history(i)) for i in (1, 2, 3)))
        assert counts == sorted(counts)
        assert counts[-1] >= counts[0] + 10  # the reader did not stop the writer
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        os.close(ends[0])


def test_who_reads_cannot_change(tmp_path: Path) -> None:
    path = tmp_path / "objects.sqlite"
    found(path)
    with (
        closing(opened(path, read_only=True)) as reader,
        pytest.raises(ConfigError, match="open for reading only"),
    ):
        reader.set_state(1, StoneState.LOST, 2.0)


def test_there_must_be_something_to_read(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"no object database .* give the folder of a run"):
        opened(tmp_path / "objects.sqlite", read_only=True)
    assert not list(tmp_path.iterdir())
