"""The scripts that plant faults: what they change, what they leave alone, and what they answer."""

import ast
import importlib
import json
import os
from pathlib import Path

import psutil
import pytest

TESTS = Path(__file__).parent
SOURCE = '''"""A docstring, 1 < 2."""

import logging
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    LIMIT = 3

COUNT: int = 4


def chosen(a, b, flag=True):
    """Say that 5 < 6."""
    logging.info("%s %s", a, 7)
    if a < b and not flag:
        raise ValueError(f"{a + 8} is wrong" + str(9))
    total = a @ b
    total += 10  # pragma: no cover
    return total
'''


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(TESTS))
    return importlib.import_module


@pytest.fixture
def faults(load):
    source = SOURCE.encode()
    module = load("mutants.faults_of")
    found = [module.fault_of("a.py", source, one) for one in module.candidates(source)]
    return {(fault.line, fault.kind, fault.text) for fault in found if fault is not None}


def test_it_plants_the_mistakes_that_people_make(faults) -> None:
    assert {
        (9, "off by one", "5"),
        (12, "constant", "False"),
        (15, "and/or", "a < b or not flag"),
        (15, "comparison", "a <= b"),
        (15, "comparison", "a >= b"),
        (15, "not", "flag"),
        (15, "not", "not (a < b and (not flag))"),
        (16, "removed statement", "pass"),
        (17, "swapped product", "b @ a"),
        (19, "returned value", "return None"),
    } == faults


def test_every_fault_is_a_source_that_differs_in_one_place(load) -> None:
    module, source = load("mutants.faults_of"), SOURCE.encode()
    for one in module.candidates(source):
        fault = module.fault_of("a.py", source, one)
        planted = fault.planted(source)
        assert ast.dump(ast.parse(planted)) != ast.dump(ast.parse(source))
        assert load("mutants.fault").REACHED.encode() in fault.exposed(source)
        assert len(fault.diff(source).splitlines()) == 2


def test_operands_keep_their_order_of_evaluation(load) -> None:
    module = load("mutants.faults_of")
    source = b"x = (a @ b) @ c\ny = 2 * -a\n"
    found = [module.fault_of("a.py", source, one) for one in module.candidates(source)]
    texts = {fault.planted(source).decode().splitlines()[fault.line - 1] for fault in found}
    assert texts == {
        "x = c @ (a @ b)",
        "x = (b @ a) @ c",
        "y = 2 / -a",
        "y = 3 * -a",
        "y = 2 * a",
    }


@pytest.mark.parametrize(
    ("source", "texts"),
    [
        ("gap_m < limit_m", {"gap_m >= limit_m"}),
        ("norm(a) > 0.5", {"norm(a) <= 0.5"}),
        ("gap_m - 0.1 <= most", {"gap_m - 0.1 > most"}),
        ("gap_m < 0", {"gap_m <= 0", "gap_m >= 0", "gap_m < 1"}),
        ("stamp_s < 0.5", {"stamp_s <= 0.5", "stamp_s >= 0.5", "stamp_s < 1.0"}),
        ("a / b_share < 0.5", {"a / b_share <= 0.5", "a / b_share >= 0.5"}),
        ("count < most", {"count <= most", "count >= most"}),
        ("zip(a, b, strict=True)", set()),
    ],
)
def test_measured_quantities_are_never_equal_but_zero_times_shares_and_counts_are(
    load, source, texts
) -> None:
    module = load("mutants.faults_of")
    planted = source.encode()
    found = [module.fault_of("a.py", planted, one) for one in module.candidates(planted)]
    made = {one.planted(planted).decode() for one in found}
    assert made >= texts
    shifts = {source.replace(" < ", " <= "), source.replace(" > ", " >= ")} - {source}
    assert made & shifts == texts & shifts


# Without the plugins that other packages bring to pytest, it starts in half a second.
PLAIN = '[tool.pytest.ini_options]\naddopts = "-p no:dash -p no:hypothesispytest -p no:anyio"\n'


def project(root: Path, test: str) -> Path:
    """Make a small tree: one function that is tested well, and one that the given test calls."""
    for folder in ("executive", "tests"):
        (root / folder).mkdir(parents=True)
    (root / "pyproject.toml").write_text(PLAIN)
    (root / "executive" / "__init__.py").write_text("")
    (root / "executive" / "sums.py").write_text(
        "def more(a, b):\n    return a + b\n\n\ndef less(a, b):\n    return a - b\n"
    )
    (root / "tests" / "test_sums.py").write_text(
        "from executive.sums import less, more\n\n\n"
        f"def test_more():\n    assert more(2, 3) == 5\n\n\n{test}"
    )
    return root


@pytest.mark.parametrize(
    ("test", "statuses", "ends"),
    [
        ("def test_less():\n    assert less(5, 2) == 3\n", {"killed"}, 0),
        ("def test_less():\n    less(5, 2)\n", {"killed", "survived"}, 1),
        ("", {"killed", "not covered"}, 1),
    ],
)
def test_survivors_end_with_1(load, tmp_path, capsys, test, statuses, ends) -> None:
    root = project(tmp_path / "tree", test)
    words = ["--root", str(root), "--map", str(tmp_path / "map"), "--count", "9", "--json"]
    assert load("mutation").main(words) == ends
    answer = json.loads(capsys.readouterr().out)
    assert {one["status"] for one in answer["mutants"]} == statuses
    assert {one["line"] for one in answer["mutants"]} == {2, 6}
    assert "return a + b" in (root / "executive" / "sums.py").read_text()  # never in place


def test_a_busy_computer_makes_no_fault_time_out(load, tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.setattr(load("mutation"), "GRACE_S", 0.2)  # less than pytest takes to start
    root = project(tmp_path / "tree", "def test_less():\n    less(5, 2)\n")
    words = ["--root", str(root), "--map", str(tmp_path / "map"), "--count", "3", "--json"]
    load("mutation").main(words)
    statuses = {one["status"] for one in json.loads(capsys.readouterr().out)["mutants"]}
    assert statuses == {"killed", "survived"}


def test_a_listed_equivalent_is_left_out(load, tmp_path, capsys) -> None:
    root = project(tmp_path / "tree", "")
    (root / "tests" / "mutants").mkdir()
    (root / "tests" / "mutants" / "equivalent.toml").write_text(
        '[[mutant]]\nfile = "executive/sums.py"\nreason = "As a test."\n'
        'diff = """\n-    return a - b\n+    return a + b\n"""\n'
    )
    assert load("mutation").main(["--root", str(root), "--count", "9", "--list"]) == 0
    out = capsys.readouterr().out
    assert "return a - b\n+    return a + b" not in out
    assert "return a + b\n+    return a - b" in out


def test_tests_that_fail_without_a_fault_are_wrong_input(load, tmp_path, capsys) -> None:
    root = project(tmp_path / "tree", "def test_less():\n    assert less(5, 2) == 4\n")
    with pytest.raises(SystemExit) as end:
        load("mutation").main(
            [
                "--root",
                str(root),
                "--map",
                str(tmp_path / "map"),
                "--count",
                "1",
                "--only",
                "executive/sums.py",
            ]
        )
    assert end.value.code == 2
    assert "failed without any fault" in capsys.readouterr().err


def test_a_test_file_that_can_no_longer_be_collected_judges_nothing(load, tmp_path, capsys) -> None:
    root = project(tmp_path / "tree", "")
    words = ["--root", str(root), "--map", str(tmp_path / "map"), "--only", "executive/sums.py"]
    assert load("mutation").main([*words, "--count", "1"]) in (0, 1)
    (root / "tests" / "conftest.py").write_text("raise RuntimeError\n")  # no part of the map
    with pytest.raises(SystemExit) as end:
        load("mutation").main([*words, "--count", "9"])
    assert end.value.code == 2


def test_a_constant_is_noticed_by_a_test_that_calls_no_function_of_its_module(
    load, tmp_path
) -> None:
    root = project(
        tmp_path / "tree",
        "def test_less():\n    assert less(5, 2) == 3\n\n\n"
        "def test_limit():\n    from executive import sums\n\n    assert sums.LIMIT == 4\n",
    )
    with (root / "executive" / "sums.py").open("a") as file:
        file.write("\n\nLIMIT = 4\n")
    words = ["--root", str(root), "--map", str(tmp_path / "map"), "--no-slow", "--count", "12"]
    assert load("mutation").main(words) == 0


def test_tests_beside_one_that_reaches_a_line_run_after_all_that_reach_it(load) -> None:
    reach, fault = load("mutants.reach_map"), load("mutants.fault")
    source = b"def one():\n    return 1\n"
    span = fault.Span(source.index(b"return"), len(source) - 1)
    planted = fault.Fault("executive/a.py", 2, "returned value", span, "return None", span)
    there, elsewhere = {"executive/a.py": 1 << 2}, {"executive/b.py": 1 << 2}
    tests = [
        reach.MappedTest("tests/test_x.py::test_uses_a_fixture", 0.1, elsewhere),
        reach.MappedTest("tests/test_x.py::test_sets_a_fixture_up", 0.1, there),
        reach.MappedTest("tests/test_y.py::test_another_file", 0.1, elsewhere),
        reach.MappedTest("tests/test_z.py::test_reaches", 9.0, there),
    ]
    chosen = reach.ReachMap(tests).tests_of(planted, source, [])
    assert [one.name.partition("::test_")[2] for one in chosen] == [
        "sets_a_fixture_up",
        "reaches",
        "uses_a_fixture",
    ]


def test_the_same_seed_draws_the_same_faults(load) -> None:
    drawn = load("mutants.faults_of").drawn
    root = TESTS.parent
    first, again, other = (list(drawn(root, ["executive/geometry"], 5, s)) for s in (1, 1, 2))
    assert first == again != other


def test_tests_are_those_that_mirror_hold_and_import_a_file(load) -> None:
    related = load("mutants.related_tests").related
    near, wide, kit = related(TESTS.parent, "plugins/monitoring/hold_state.py")
    assert kit[-2:] == ("monitoring", "executive/testing/suites")
    assert all("tests/plugins/monitoring" in test for test in near[:1])
    assert "tests/plugins/monitoring" in wide
    assert related(TESTS.parent, "executive/geometry/pose.py")[1] == ("tests/geometry",)
    assert related(TESTS.parent, "executive/config.py")[0] == ("tests/test_config.py",)


def test_tests_beside_the_mirror_of_a_folder_belong_to_its_files(load) -> None:
    related = load("mutants.related_tests").related
    both = ("tests/tree/test_import.py", "tests/tree/test_export.py")
    for file in ("names.py", "import_xml.py"):  # the second one is named by one of the two
        stages = related(TESTS.parent, f"executive/tree/btcpp/{file}")
        assert [stage for stage in stages if both[0] in stage] == [("tests/tree/btcpp", *both)]
    assert not any(both[0] in one for one in related(TESTS.parent, "executive/tree/load.py")[1:2])
    leaf = related(TESTS.parent, "executive/leaf/port.py")
    assert ("tests/leaf", "tests/behaviours", "tests/mission") in leaf


def test_recorded_results_of_the_mirror_run_first(load) -> None:
    related = load("mutants.related_tests").related
    assert related(TESTS.parent, "plugins/monitoring/hold_state.py")[0] == (
        "tests/plugins/monitoring/test_hold_state.py",
        "tests/recorded/plugins/monitoring",
    )
    room = related(TESTS.parent, "plugins/estimation/filters/error_state_ekf.py")[0]
    assert room[-1] == "tests/recorded/plugins/estimation"
    graph = related(TESTS.parent, "plugins/estimation/graph/window.py")[0]
    assert graph[-2:] == (
        "tests/recorded/plugins/estimation/graph",
        "tests/recorded/plugins/estimation",
    )
    assert not related(TESTS.parent, "executive/arrays.py")[0][1:]


LEAF = '''class Both:
    """A leaf."""

    def run(self):
        """Say nothing."""
        yield None


class Short:
    def check(self):
        return 1
'''


def test_a_leaf_is_broken_first_in_its_verb(load) -> None:
    Leaf = load("broken_leaves").Leaf
    broken = Leaf("Both", "a.py", "Both").broken(LEAF)
    assert '"""Say nothing."""\n        raise RuntimeError' in broken
    assert "def check(self):\n        raise" in Leaf("Short", "a.py", "Short").broken(LEAF)
    with pytest.raises(ValueError, match="neither run nor check"):
        Leaf("None", "a.py", "None").broken(LEAF)


def test_every_shipped_leaf_can_be_broken(load) -> None:
    leaves = load("broken_leaves").leaves_of(TESTS.parent)
    assert len(leaves) > 20
    for leaf in leaves:
        broken = leaf.broken((TESTS.parent / leaf.file).read_text(encoding="utf-8"))
        ast.parse(broken)


def test_tests_that_name_a_leaf_run_first(load, tmp_path) -> None:
    script, folder = load("broken_leaves"), tmp_path / "tests" / "behaviours"
    folder.mkdir(parents=True)
    (folder / "test_a.py").write_text("from x import Good\nGood().check()\n")
    (folder / "test_b.py").write_text("Good()\n")
    (folder / "test_c.py").write_text("Goodness()\n")
    leaf = script.Leaf("Good", "a.py", "Good")
    assert script.naming(leaf, tmp_path) == [
        "tests/behaviours/test_b.py",
        "tests/behaviours/test_a.py",
    ]


def test_code_is_compiled_once_and_a_fault_is_noticed_all_the_same(load, tmp_path) -> None:
    test = "from executive import sums\n\n\ndef test_less():\n    assert sums.less(5, 2) == 3\n"
    root = project(tmp_path / "tree", test)
    with load("mutants.tree_copy").TreeCopy(root) as copy:
        file = copy.root / "executive" / "sums.py"
        (compiled,) = (file.parent / "__pycache__").glob("sums.*.pyc")
        kept = compiled.read_bytes()
        assert copy.run(["tests"], 60.0).is_green
        old = file.stat()
        with copy.with_source("executive/sums.py", file.read_bytes().replace(b" - ", b" + ")):
            os.utime(file, ns=(old.st_atime_ns, old.st_mtime_ns))  # the same time and size
            assert not copy.run(["tests"], 60.0).is_green
        assert copy.run(["tests"], 60.0).is_green
        assert compiled.read_bytes() == kept


def test_what_hangs_is_ended_with_what_it_started_and_the_next_run_is_not_disturbed(
    load, tmp_path
) -> None:
    test = (
        "import subprocess, time\n\n\ndef test_hang():\n"
        "    started = subprocess.Popen(['sleep', '60'])\n"
        "    open('id', 'w').write(str(started.pid))\n    time.sleep(60)\n"
    )
    root = project(tmp_path / "tree", test)
    with load("mutants.tree_copy").TreeCopy(root) as copy:
        ran = copy.run(["tests/test_sums.py::test_hang"], 3.0)
        assert (ran.status, ran.first_failure, ran.is_green) == (None, "", False)
        started = (copy.root / "id").read_text()
        assert not Path("/proc", started).exists() or psutil.Process(int(started)).status() in (
            psutil.STATUS_ZOMBIE,
            psutil.STATUS_DEAD,
        )
        assert copy.run(["tests/test_sums.py::test_more"], 60.0).is_green


LOADED = """from functools import cache, wraps

TABLE = [n * 2 for n in range(3)]


def at_import(a):
    return a + 1


BASE = at_import(4)


def twice(function):
    @wraps(function)
    def called(a):
        return function(a) + function(a)

    return called


@twice
def sum_of(a, step=2):
    return a + step


@cache
def kept(a):
    return [one - 1 for one in a]


class Counter:
    limit = 3

    @property
    def left(self):
        return self.limit - 1
"""
CALLS = """from executive.loaded import *


def test_all():
    assert (TABLE, BASE, sum_of(1), kept((5,)), Counter().left) == ([0, 2, 4], 5, 6, [4], 2)
"""


@pytest.mark.parametrize(
    ("before", "after", "is_in_a_fork"),
    [
        ("a + step", "a - step", True),
        ("function(a) + function(a)", "function(a) - function(a)", True),
        ("one - 1", "one + 1", True),
        ("self.limit - 1", "self.limit + 1", True),
        ("step=2", "step=3", False),
        ("a + 1", "a - 1", False),
        ("n * 2", "n / 2", False),
        ("limit = 3", "limit = 4", False),
    ],
)
def test_a_fault_in_what_is_loaded_is_noticed_and_one_at_the_import_refused(
    load, tmp_path, before, after, is_in_a_fork
) -> None:
    root = project(tmp_path / "tree", "")
    (root / "executive" / "loaded.py").write_text(LOADED)
    (root / "tests" / "test_loaded.py").write_text(CALLS)
    names = ["tests/test_loaded.py::test_all"]
    with load("mutants.tree_copy").TreeCopy(root) as copy:
        copy.collect()
        assert copy.run_collected(names, 60.0).is_green
        with copy.with_source("executive/loaded.py", LOADED.replace(before, after).encode()):
            ran = copy.run_collected(names, 60.0)
            assert (ran is not None) == is_in_a_fork
            assert ran is None or ran.first_failure == "FAILED tests/test_loaded.py::test_all"
            assert not copy.run_only(names, 60.0).is_green
        assert copy.run_collected(names, 60.0).is_green  # a fork leaves nothing behind
        assert copy.run_collected(["tests/test_loaded.py::test_none"], 60.0) is None


def test_compiled_functions_of_what_imports_a_file_are_set_aside_while_it_is_wrong(
    load, tmp_path
) -> None:
    root = project(tmp_path / "tree", "")
    package = root / "executive"
    (package / "sums.py").write_text("njit = str\n")
    (package / "users.py").write_text("from executive.sums import njit\n")
    (package / "far.py").write_text("def late():\n    from executive import users\n")
    (package / "other.py").write_text("")
    with load("mutants.tree_copy").TreeCopy(root) as copy:
        cache = copy.root / "executive" / "__pycache__"
        kept = [cache / f"{name}.f-1.py311.nbi" for name in ("sums", "users", "far", "other")]
        for file in kept:
            file.write_text(file.name)
        with copy.with_source("executive/sums.py", b"njit = int\n"):
            assert [file.is_file() for file in kept] == [False, False, False, True]
            kept[1].write_text("compiled with the fault")
            (cache / "far.g-2.py311.1.nbc").write_text("so is this")
        assert [file.read_text() for file in kept] == [file.name for file in kept]
        assert sorted(cache.glob("*.nb?")) == sorted(kept)


@pytest.mark.parametrize(("called", "ends"), [("Good().check()", 0), ("Good", 1)])
def test_a_leaf_that_stays_green_ends_with_1(load, tmp_path, called, ends) -> None:
    root = project(tmp_path / "tree", "")
    points = '[project.entry-points."executive.behaviour.v1"]\nGood = "executive.good:Good"\n'
    (root / "pyproject.toml").write_text(PLAIN + points)
    (root / "executive" / "good.py").write_text("class Good:\n    def check(self):\n        pass\n")
    (root / "tests" / "behaviours").mkdir()
    (root / "tests" / "behaviours" / "test_good.py").write_text(
        f"from executive.good import Good\n\n\ndef test_good():\n    {called}\n"
    )
    assert load("broken_leaves").main(["--root", str(root)]) == ends
