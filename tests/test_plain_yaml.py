"""YAML that is no text, hides a bomb, or nests without end: refused with file, line and cure."""

from pathlib import Path

import pytest

from executive.errors import ConfigError
from executive.machine.machine import load_machine
from executive.plain_yaml import read_plain_yaml


def test_a_document_is_read(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("\ufeffjoints: [1, 2.5, zwei]\nname: m\n", encoding="utf-8")
    assert read_plain_yaml(path) == {"joints": [1, 2.5, "zwei"], "name": "m"}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"name: a\nmass: \xff\xfe\n", r"robot\.yaml:2: not UTF-8 text \(byte 0xff\); save it as"),
        (b"a: &a [1, 2]\nb: [*a, *a]\n", r"robot\.yaml:2: aliases \(\*\) are refused"),
        (b"[" * 5000, r"robot\.yaml:1: nested more than 60 levels deep"),
        (b"seen: 2026-99-99\n", r"robot\.yaml: not readable as YAML: .*; quote the text"),
        (b"mass: " + b"9" * 5000, r"robot\.yaml: not readable as YAML"),
        (b"a: [1\n", r"robot\.yaml: not readable as YAML"),
        (b"# " + bytes(10_000_001), r"robot\.yaml: more than 10,000,000 bytes"),
    ],
)
def test_what_a_loader_would_choke_on_is_refused(
    tmp_path: Path, content: bytes, words: str
) -> None:
    path = tmp_path / "robot.yaml"
    path.write_bytes(content)
    with pytest.raises(ConfigError, match=words):
        read_plain_yaml(path)
    with pytest.raises(ConfigError, match=words):
        load_machine(str(tmp_path))
