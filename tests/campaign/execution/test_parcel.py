"""The files of a run come back whole, within their limit, and into their own folder only."""

import io
import zipfile
from pathlib import Path

import pytest

from executive.campaign.execution.parcel import NOT_KEPT, pack, unpack
from executive.errors import DataError

LIMIT = 10_000


@pytest.fixture
def run(tmp_path: Path) -> Path:
    folder = tmp_path / "run"
    (folder / "maps").mkdir(parents=True)
    (folder / "report.json").write_text("{}")
    (folder / "log.txt").write_text("all is well\n" * 100)
    (folder / "maps" / "map.ply").write_bytes(b"m" * 9000)
    (folder / "secret.txt").write_text("not asked for")
    return folder


def archive(**files: bytes) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as made:
        for name, content in files.items():
            made.writestr(name, content)
    return packed.getvalue()


def test_what_is_kept_comes_back(run: Path, tmp_path: Path) -> None:
    unpack(pack(run, ["report.json", "*.txt"], LIMIT), tmp_path / "back", LIMIT)
    back = {one.name: one.read_bytes() for one in (tmp_path / "back").iterdir()}
    assert back == {
        one: (run / one).read_bytes() for one in ("report.json", "log.txt", "secret.txt")
    }


def test_a_file_beyond_the_limit_is_named_and_left_out(run: Path, tmp_path: Path) -> None:
    unpack(pack(run, ["report.json", "log.txt", "maps/*"], LIMIT), tmp_path, LIMIT)
    assert not (tmp_path / "maps").exists()
    assert (tmp_path / "log.txt").exists()
    assert "maps/map.ply: 9000 bytes" in (tmp_path / NOT_KEPT).read_text()


def test_a_link_is_not_followed(run: Path, tmp_path: Path) -> None:
    (run / "other.txt").symlink_to("/etc/hostname")
    unpack(pack(run, ["*.txt"], LIMIT), tmp_path / "back", LIMIT)
    assert not (tmp_path / "back" / "other.txt").exists()


@pytest.mark.parametrize("name", ["../outside", "/outside", "a/../../outside"])
def test_a_name_that_leads_out_is_refused_before_anything_is_written(
    tmp_path: Path, name: str
) -> None:
    with pytest.raises(DataError, match="leads out"):
        unpack(archive(**{"report.json": b"{}", name: b"x"}), tmp_path / "back", LIMIT)
    assert not (tmp_path / "back").exists()


def test_more_than_the_limit_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="larger than"):
        unpack(archive(zeros=bytes(LIMIT + 1)), tmp_path, LIMIT)


def test_a_broken_parcel_is_refused(run: Path, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="did not arrive whole"):
        unpack(pack(run, ["*"], LIMIT)[:50], tmp_path, LIMIT)
