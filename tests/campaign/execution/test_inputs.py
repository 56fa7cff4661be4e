"""Inputs are told apart by content, arrive whole or not at all, and stay as they arrived."""

from pathlib import Path

import pytest

from executive.campaign.execution import inputs
from executive.campaign.execution.inputs import Chunk, InputCache, chunks_of, digest_of
from executive.errors import ConfigError, DataError


@pytest.fixture
def stones(tmp_path: Path) -> Path:
    folder = tmp_path / "here" / "stones"
    (folder / "more").mkdir(parents=True)
    (folder / "a.ply").write_bytes(b"a" * 1000)
    (folder / "empty.txt").touch()
    (folder / "more" / "b.ply").write_bytes(bytes(range(256)) * 40)
    return folder


@pytest.fixture
def cache(tmp_path: Path) -> InputCache:
    return InputCache(tmp_path / "cache")


def arrived(cache: InputCache, path: Path) -> Path:
    digest = digest_of(path)
    for chunk in chunks_of(path):
        cache.receive(digest, chunk)
    cache.complete(digest)
    found = cache.find(digest)
    assert found is not None
    return found


def content(path: Path) -> dict[str, bytes]:
    return {
        str(one.relative_to(path)): one.read_bytes() for one in path.rglob("*") if one.is_file()
    }


def test_a_folder_arrives_as_it_is(
    cache: InputCache, stones: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(inputs, "CHUNK_BYTES", 999)
    copy = arrived(cache, stones)
    assert copy.name == "stones"
    assert content(copy) == content(stones)


def test_a_file_keeps_its_name(cache: InputCache, stones: Path) -> None:
    copy = arrived(cache, stones / "a.ply")
    assert copy.name == "a.ply"
    assert copy.read_bytes() == b"a" * 1000


def test_equal_content_has_an_equal_digest_wherever_it_is(stones: Path, tmp_path: Path) -> None:
    moved = tmp_path / "there" / "stones"
    moved.parent.mkdir()
    before = digest_of(stones)
    stones.rename(moved)
    assert digest_of(moved) == before


@pytest.mark.parametrize("change", ["byte", "name", "moved byte", "more"])
def test_any_change_changes_the_digest(stones: Path, change: str) -> None:
    before = digest_of(stones)
    match change:
        case "byte":
            (stones / "a.ply").write_bytes(b"a" * 999 + b"b")
        case "name":
            (stones / "a.ply").rename(stones / "c.ply")
        case "moved byte":  # the bytes of all files in a row stay the same
            (stones / "a.ply").write_bytes(b"a" * 999)
            (stones / "empty.txt").write_bytes(b"a")
        case "more":
            (stones / "c.ply").touch()
    assert digest_of(stones) != before


def test_what_arrives_changed_is_refused(cache: InputCache, stones: Path) -> None:
    digest = digest_of(stones)
    for chunk in chunks_of(stones):
        cache.receive(digest, Chunk(chunk.name, chunk.offset, chunk.content.replace(b"a", b"b")))
    with pytest.raises(DataError, match=digest):
        cache.complete(digest)
    assert cache.find(digest) is None


def test_a_changed_copy_is_removed_and_can_arrive_again(cache: InputCache, stones: Path) -> None:
    copy = arrived(cache, stones) / "a.ply"
    copy.chmod(0o644)
    copy.write_bytes(b"b" * 1000)
    assert cache.find(digest_of(stones)) is None
    assert content(arrived(cache, stones)) == content(stones)


def test_a_cache_that_is_shared_keeps_the_first(tmp_path: Path, stones: Path) -> None:
    first = arrived(InputCache(tmp_path / "cache"), stones)
    assert arrived(InputCache(tmp_path / "cache"), stones) == first
    assert len(list((tmp_path / "cache").iterdir())) == 1


@pytest.mark.parametrize("name", ["../a", "/etc/passwd", "stones/../../a", "", "a\\..\\b"])
def test_a_name_that_leads_out_is_refused(cache: InputCache, name: str) -> None:
    with pytest.raises(DataError, match="leads out"):
        cache.receive("0" * 64, Chunk(name, 0, b"x"))


def test_what_cannot_be_an_input_is_refused(tmp_path: Path, stones: Path) -> None:
    with pytest.raises(ConfigError, match="does not exist"):
        digest_of(tmp_path / "absent")
    (tmp_path / "bare").mkdir()
    with pytest.raises(ConfigError, match="without files"):
        digest_of(tmp_path / "bare")
    (stones / "link").symlink_to(tmp_path)
    with pytest.raises(ConfigError, match="neither a file nor a folder"):
        digest_of(stones)
