"""The shipped examples do what their names say, by what the simulator knows."""

import pytest

pytestmark = pytest.mark.mission

STONES = 3


@pytest.fixture(scope="module")
def sorted_site(tmp_path_factory, command_line, read_run):
    folder = tmp_path_factory.mktemp("sort") / "run"
    count = ("--set", f"robot.site.stones.count={STONES}")
    answer = command_line("run", "sort", *count, "--run-dir", str(folder))
    return read_run(folder, answer.status)


def test_sort_ends_with_success(sorted_site):
    assert (sorted_site.report["outcome"], sorted_site.report["reason"]) == ("success", "")


def test_sort_puts_each_stone_into_the_row_of_its_size(sorted_site, check_truth):
    check_truth(sorted_site, placed=STONES)
    for stone in sorted_site.report["truth"]["stones"]:
        side = 1 if stone["volume_m3"] > 0.7 else -1  # the larger ones to the left of the machine
        assert side * stone["centre_m"][1] > 4.0
