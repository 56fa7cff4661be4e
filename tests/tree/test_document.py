"""Documents: values with places, the core schema of YAML 1.2, and bytes that are no document at
all.
"""

import math
from pathlib import Path
from typing import Any

import pytest

from executive.tree.document import read_bytes, read_file, read_text
from executive.tree.problem import Mark, Problems
from executive.tree.scalar import SurpriseError, resolve
from executive.tree.value import Table, plain


def read(data: bytes | str) -> tuple[Any, list[str]]:
    """Return the plain value, and what was found wrong."""
    problems = Problems()
    value = (
        read_bytes(data, "f", problems)
        if isinstance(data, bytes)
        else read_text(data, "f", problems)
    )
    return (None if value is None else plain(value)), [str(problem) for problem in problems.all()]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("", None), ("~", None), ("null", None), ("NULL", None), ("true", True), ("False",
        False), ("TRUE", True),
        ("0", 0), ("-12", -12), ("+3", 3), ("0o17", 15), ("0x1F", 31), ("1.5", 1.5), (".5", 0.5),
        ("5.", 5.0),
        ("1e3", 1000.0), ("-1.5E-2", -0.015), (".inf", math.inf), ("-.INF", -math.inf),
        ("y", "y"), ("n", "n"), ("nULL", "nULL"), ("tRUE", "tRUE"), ("120 "
"s", "120 s"), ("1.2.3", "1.2.3"),
        ("e3", "e3"), ("0o8", "0o8"), ("+.inf", math.inf), ("-", "-"), (".", "."), ("12e", "12e"),
        ("9" * 400, "9" * 400),
    ],
)  # fmt: skip
def test_a_plain_scalar_follows_the_core_schema(text: str, value: object) -> None:
    resolved = resolve(text)
    assert resolved == value
    assert type(resolved) is type(value)


def test_not_a_number_is_a_number() -> None:
    assert math.isnan(resolve(".nan"))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "text",
    ["yes", "No", "ON", "off", "010", "-07", "12:30", "1:00:00", "12:30.5", "2026-01-31",
    "2026-1-3 "
""
""
""
"10:00", "0b11",
     "1_000", "0xF_F", "1_0.5"],
)  # fmt: skip
def test_what_two_versions_of_yaml_read_differently_is_refused(text: str) -> None:
    with pytest.raises(SurpriseError, match=r"YAML 1\.1"):
        resolve(text)
    assert read(f"- '{text}'\n") == ([text], [])  # quoted, it is text in both


def test_every_value_knows_its_place() -> None:
    value = read_text("a: 1\nb:\n  - x\n  - {c: ü, d: 2}\n", "f", Problems())
    assert isinstance(value, Table)
    inner = value.get("b").items[1]  # type: ignore[union-attr]
    assert value.entries["b"].key_mark == Mark("f", 2, 1)
    assert inner.entries["d"].key_mark == Mark("f", 4, 12)
    assert inner.get("d").mark == Mark("f", 4, 15)


def test_columns_count_characters_not_bytes() -> None:
    _, problems = read("ü: [ä, ö, yes]\n".encode())
    assert problems[0].startswith("f:1:11: ")


def test_all_mistakes_of_a_document_are_told() -> None:
    value, problems = read("a: yes\na: 2\nb: *x\nc: !t 3\n<<: {d: 1}\n")
    assert value == {"a": None, "b": None, "c": None}
    assert [problem.split(": ")[0] for problem in problems] == [
        "f:1:4",
        "f:2:1",
        "f:3:4",
        "f:4:4",
        "f:5:1",
    ]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "f:1:1: error: the file is empty"),
        (b"\xef\xbb\xbf# bom\n", "f:1:1: error: the file is empty"),
        (b"\xff\xfea\x00", "f:1:1: error: not UTF-8 text (byte 0xff)"),
        (b"a: 1\nb: \xe9t\xe9\n", "f:2:4: error: not UTF-8 text (byte 0xe9)"),
        (b"a: \x00\n", "f:1:4: error: a control character (U+0000)"),
        (b"a: \x1b[0m\n", "f:1:4: error: a control character (U+001B)"),
        # Newer versions of the library stop at the thousandth bracket, before they give the first.
        (b"[" * 100_000, "1: error: nested more than 60 levels deep"),
        (b"- " * 100_000, "f:1:121: error: nested more than 60 levels deep"),
        (b"%YAML 3.0\n---\na: 1\n", "not YAML: found incompatible YAML document"),
        (b"? a\n? b\n", ""),
    ],
)
def test_bytes_that_are_no_mission_are_an_error_and_no_traceback(data: bytes, words: str) -> None:
    _, problems = read(data)
    assert (words in problems[0]) if words else not problems


def test_a_byte_order_mark_is_no_content() -> None:
    assert read(b"\xef\xbb\xbfa: 1\n") == ({"a": 1}, [])


def test_a_folder_a_missing_file_and_a_huge_one_are_errors(tmp_path: Path) -> None:
    huge = tmp_path / "huge.yaml"
    huge.write_bytes(b"#" * 11_000_000)
    told = []
    for path in (
        tmp_path,
        tmp_path / "none.yaml",
        huge,
        Path("a\0b.yaml"),
        Path("x" * 5000 + ".yaml"),
    ):
        problems = Problems()
        assert read_file(path, "f", problems) is None
        told.append(str(problems.all()[0]))
    assert told[0] == "f: error: this is a folder, not a mission file"
    assert told[1] == "f: error: cannot be read: No such file or directory"
    assert told[2] == "f: error: more than 10,000,000 bytes: this is no mission file"
    assert told[3] == "f: error: cannot be read: embedded null byte"
    assert told[4] == "f: error: cannot be read: File name too long"


@pytest.mark.parametrize(
    ("kind", "first"),
    [("mission", "api: 1"), ("campaign", "api: 1"), ("structure", "structure: wall")],
)
def test_an_empty_file_is_told_how_one_of_its_kind_begins(kind: str, first: str) -> None:
    problems = Problems()
    assert read_text("# nothing yet", "f", problems, kind) is None
    (problem,) = problems.all()
    assert str(problem) == f"f:1:1: error: the file is empty; a {kind} begins with '{first}'"
