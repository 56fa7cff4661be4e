"""Whatever stands in a file, loading it ends in a mission or in a list of mistakes, never in a
traceback.
"""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from executive.tree.catalogue import TableCatalogue
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError

GOOD = """
api: 1
mission: good
extends: good_base
loop: {tick: 50 ms}
plugins:
  robot: {plugin: mujoco, site: {stones: {count: 3}, size_m: [1, 2]}}
  monitoring: [jaw_slip, {plugin: payload_drop}]
trees:
  main:
    sequence:
      - {run: Scan, with: {angle: 90 deg}, out: {cloud: "{c}"}, retry: {attempts: 3, pause: 1 s}}
      - {run: FindStones, in: {cloud: "{c}"}, on_failure: {wait: 1 s}, timeout: 3}
      - {for_each: {item: s, in: "{stones}"}, do: {call: pick, in: {stone: "{s}"}}, if: {not: Calm}}
      - {loop: {until: {all: [Calm, {any: [Calm]}]}, max: 3}, do: {ask: "Go on?", default: false}}
      - {parallel: [{wait: 1}, {set: {a: [1], b: "{s}"}}], succeed: one, name: x, while: Calm}
  pick: {in: {stone: Stone, tool: str?}, out: {held: bool}, run: Pick, optional: true}
"""
BASE = (
    "api: 1\nmission: good_base\nplugins: {estimation: gnss_imu, mapping: voxel_map, "
    "robot: replay}\n"
)
SIGNS = [
    "{",
    "}",
    "[",
    "]",
    ":",
    "- ",
    "\n",
    "  ",
    "\t",
    '"',
    "'",
    "&a",
    "*a",
    "!!int",
    "<<:",
    "|",
    ">",
    "? ",
    "#",
    "%",
]
VALUES = [
    "null",
    "~",
    ".nan",
    ".inf",
    "-1",
    "1e999",
    "9" * 320,
    "yes",
    "010",
    "---",
    "ü",
    "\0",
    "🪨",
    "{}",
    "[]",
]
QUOTED = ['"\\ud800"', '"\\0"', '"{key}"', '"a\\nb"']
WORDS = [*GOOD.split(), *SIGNS, *VALUES, *QUOTED]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("damaged")
    (path / "good_base.yaml").write_text(BASE)
    return path


def check(folder: Path, catalogue: TableCatalogue, data: bytes, *options: str) -> None:
    path = folder / "mission.yaml"
    path.write_bytes(data)
    try:
        load_mission(str(path), options, catalogue)
    except MissionFileError as error:
        told = str(error).splitlines()
    else:
        return
    assert told
    assert all(": error: " in line for line in told)


quick = settings(
    max_examples=100,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


def test_the_file_that_is_damaged_here_is_good(folder: Path, catalogue: TableCatalogue) -> None:
    text = GOOD.replace('b: "{s}"', "b: 2")
    (folder / "mission.yaml").write_text(text)
    assert load_mission(str(folder / "mission.yaml"), (), catalogue).name == "good"


@quick
@given(data=st.binary(max_size=200))
def test_any_bytes(folder: Path, catalogue: TableCatalogue, data: bytes) -> None:
    check(folder, catalogue, data)


@quick
@given(words=st.lists(st.sampled_from(WORDS), max_size=40))
def test_any_words_of_the_language(
    folder: Path, catalogue: TableCatalogue, words: list[str]
) -> None:
    check(folder, catalogue, " ".join(words).encode("utf-8"))


@settings(quick, max_examples=300)
@given(
    edits=st.lists(
        st.tuples(st.integers(0, len(GOOD)), st.integers(0, 12), st.sampled_from(["", *WORDS])),
        min_size=1,
        max_size=3,
    )
)
def test_a_good_file_with_pieces_cut_out_and_put_in(
    folder: Path, catalogue: TableCatalogue, edits: list[tuple[int, int, str]]
) -> None:
    text = GOOD
    for start, length, word in edits:
        text = text[:start] + word + text[start + length :]
    check(folder, catalogue, text.encode("utf-8"))


@settings(quick, max_examples=200)
@given(start=st.integers(0, 60), target=st.integers(0, 60), word=st.sampled_from(WORDS))
def test_a_good_file_with_one_value_replaced_by_another(
    folder: Path, catalogue: TableCatalogue, start: int, target: int, word: str
) -> None:
    parts = GOOD.split(": ")
    place = start % len(parts)
    replacement = parts[target % len(parts)].split(",")[0] if target % 2 else word
    parts[place] = replacement + parts[place][min(len(parts[place]), 5) :]
    check(folder, catalogue, ": ".join(parts).encode("utf-8"))


@quick
@given(
    key=st.sampled_from(["robot", "robot.site", "robot.site.stones.count", "monitoring",
    "monitoring.jaw_slip", "loop",
                         "loop.tick", "mapping.plugin", "", ".", "trees.main"]),
    value=st.one_of(st.sampled_from(WORDS), st.text(max_size=20)),
)  # fmt: skip
def test_any_option(folder: Path, catalogue: TableCatalogue, key: str, value: str) -> None:
    check(folder, catalogue, GOOD.encode("utf-8"), f"{key}={value}")
