"""Figures as people read them, names of cells, quantiles, and the markup of a page."""

import math

import numpy as np
import pytest

from executive.campaign.figures.figures import Interval
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.last_lines import last_lines
from executive.campaign.reporting.page.markup import (
    Markup,
    joined,
    listing,
    pairs,
    prose,
    table,
    tag,
)
from executive.campaign.reporting.quantile import quantile
from executive.campaign.reporting.wording import (
    amount,
    figure,
    interval,
    number_ranges,
    percent,
    plural,
    points,
    shortened,
    wrapped,
)
from executive.interfaces.report_file import REPORT

NAN = math.nan


@pytest.mark.parametrize(
    ("value", "unit", "told"),
    [
        (NAN, "s", "–"),
        (math.inf, "", "–"),
        (3.0, "", "3"),
        (0.0, "m", "0 m"),
        (1234.5, "s", "1,234 s"),
        (100.4, "s", "100 s"),
        (99.96, "s", "100.0 s"),
        (12.345, "m", "12.3 m"),
        (0.012345, "m", "0.0123 m"),
        (1e-4, "m", "0.000100 m"),
        (0.99e-4, "m", "9.90e-05 m"),
        (-0.5, "m", "-0.500 m"),
        (3 * 2**20, "byte", "3 MiB"),
        (2500 * 2**20, "byte", "2,500 MiB"),
    ],
)
def test_an_amount_has_three_digits_and_its_unit(value, unit, told):
    assert amount(value, unit) == told


@pytest.mark.parametrize(
    ("share", "told"),
    [(NAN, "–"), (0.0, "0 %"), (1.0, "100 %"), (0.5, "50 %"), (0.0149, "1.5 %"), (0.015, "2 %"),
     (0.004, "0.4 %"), (0.985, "98 %"), (0.9851, "98.5 %"), (0.999, "99.9 %")],
)  # fmt: skip
def test_a_share_near_its_ends_has_a_tenth(share, told):
    assert percent(share) == told
    assert figure(share, "s", is_share=True) == told


def test_a_difference_of_shares_has_its_sign():
    assert [points(one) for one in (0.051, -0.5, 0.0, NAN)] == [
        "+5.1 points", "-50.0 points", "+0.0 points", "–"
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("of", "unit", "is_share", "told"),
    [
        ((1.0, 2.5), "s", False, "1 to 2.50 s"),
        ((0.2, 0.4), "", True, "20 to 40 %"),
        ((2**20, 2**22), "byte", False, "1 to 4 MiB"),
        ((NAN, NAN), "s", False, "–"),
        ((NAN, 2.0), "s", False, "≤ 2 s"),
        ((1.0, NAN), "s", False, "≥ 1 s"),
        ((1.0, 2.0), "", False, "1 to 2"),
    ],
)
def test_an_interval_may_be_open_at_either_end(of, unit, is_share, told):
    assert interval(Interval(*of), unit, is_share) == told


def test_neighbours_among_numbers_are_ranges():
    assert number_ranges([3, 1, 2, 2, 7, 9, 10]) == "1–3, 7, 9–10"
    assert number_ranges([]) == ""
    assert number_ranges([5]) == "5"


def test_texts_are_cut_and_counted():
    assert shortened("abcdef", 6) == "abcdef"
    assert shortened("abcdefg", 6) == "abcde…"
    assert [plural(count, "run") for count in (0, 1, 2, 1000)] == [
        "0 runs", "1 run", "2 runs", "1,000 runs"
    ]  # fmt: skip


def test_labels_are_broken_after_punctuation():
    assert wrapped("one, two, three", 8) == "one,\ntwo,\nthree"
    assert wrapped("estimation.plugin=dual_graph", 20) == "estimation.plugin=\ndual_graph"
    assert wrapped("a" * 60, 26) == f"{'a' * 26}\n{'a' * 26}\n{'a' * 8}"
    assert wrapped("short") == "short"
    assert wrapped("12345 7890", 10) == "12345 7890"


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.95, 1.0])
@pytest.mark.parametrize("count", [1, 2, 3, 10, 11])
def test_quantiles_are_those_of_numpy(count, share):
    values = sorted(np.random.default_rng(count).normal(size=count).tolist())
    assert quantile(values, share) == pytest.approx(float(np.quantile(values, share)), abs=1e-12)


def test_of_nothing_there_is_no_quantile():
    assert math.isnan(quantile([], 0.5))


FACTORS = {"estimation.plugin": ("a", "b"), "loop.tick": ("0.1",), "robot.plugin": ("x", "y")}


def test_a_cell_is_named_by_the_factors_that_vary():
    cells = Cells(FACTORS)
    levels = {"estimation.plugin": "a", "loop.tick": "0.1", "robot.plugin": "y"}
    assert cells.name(levels) == "a, y"
    assert cells.words(levels) == "estimation=a, robot=y"
    assert cells.title == "estimation, robot"


def test_names_that_would_be_the_same_stay_whole():
    cells = Cells({"a.rate": ("1", "2"), "b.rate": ("1", "2"), "site.count": ("7", "8")})
    assert cells.title == "a.rate, b.rate, count"


def test_where_nothing_varies_a_cell_is_all_runs():
    cells = Cells({"loop.tick": ("0.1",)})
    assert cells.name({"loop.tick": "0.1"}) == cells.words({"loop.tick": "0.1"}) == "all runs"
    assert cells.title == "cell"
    assert Cells({}).name({"made_up": "3"}) == "3"


def test_texts_are_escaped_and_markup_is_not():
    assert tag("p", "a < b", class_="x", aria_label='"') == (
        '<p class="x" aria-label="&quot;">a &lt; b</p>'
    )
    assert tag("br") == "<br>"
    assert joined(["<", Markup("<b>")]) == "&lt;<b>"
    assert prose("use `a<b` now") == "use <code>a&lt;b</code> now"
    assert listing(["a", "<"]) == "<ul><li>a</li><li>&lt;</li></ul>"
    assert pairs([("a", "b")]) == "<dl><dt>a</dt><dd>b</dd></dl>"


def test_columns_of_numbers_are_aligned_to_the_right():
    assert table(("a", "b"), [("1", "2")], numbers=(1,)) == (
        '<div class="table" tabindex="0"><table><thead><tr><th>a</th><th class="number">b</th></tr>'
        '</thead><tbody><tr><td>1</td><td class="number">2</td></tr></tbody></table></div>'
    )


def test_the_last_lines_of_a_run_that_broke_off_end_with_what_it_printed(tmp_path):
    (tmp_path / "journal.jsonl").write_text('{"a": 1}\nhalf a li\n')
    (tmp_path / "log.txt").write_text("\n".join(f"line {i}" for i in range(9)))
    (tmp_path / "output.txt").write_text("printed\n\n")
    lines = last_lines(tmp_path, 2)
    assert lines == ['{"a": 1}  (not a whole line)', "half a li  (not a whole line)", "line 8",
                     "printed"]  # fmt: skip
    (tmp_path / REPORT).write_text("{}")
    assert len(last_lines(tmp_path, 2)) == 2
    assert last_lines(tmp_path / "none") == []


def test_of_a_long_file_the_first_line_that_is_read_is_whole(tmp_path, monkeypatch):
    monkeypatch.setattr("executive.campaign.reporting.last_lines._BYTES", 12)
    (tmp_path / "log.txt").write_text("first line\nsecond\nthird")
    assert last_lines(tmp_path, 5) == ["third"]
    (tmp_path / "log.txt").write_text("first\nthird")  # as long as what is read
    assert last_lines(tmp_path, 5) == ["first", "third"]
