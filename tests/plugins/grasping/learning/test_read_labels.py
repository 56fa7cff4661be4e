"""Labels as they are read from files that were written by hand, and stones as they are drawn."""

from pathlib import Path

import numpy as np
import pytest
from executive_plugins.grasping.learning import labels
from executive_plugins.grasping.learning.labels import (
    LabelSettings,
    read_labels,
    resting_stone,
    stone_file,
)

from executive.geometry.pose import pose


def test_stones_are_read_in_order_and_lifted_up_to_twenty_centimetres_of_slip(
    tmp_path: Path,
) -> None:
    slips = {12: [0.1, 0.3], 3: [0.2], 100_000: [0.21, 0.0, 9.0]}
    for number, slip_m in slips.items():
        n = len(slip_m)
        images = np.full((n, 2), number % 256, dtype=np.uint8)
        numbers = np.arange(n, dtype=np.float32)[:, None] + number
        np.savez(stone_file(tmp_path, number), images=images, numbers=numbers, slip=slip_m)
    found = read_labels(tmp_path)
    assert found.stone.tolist() == [3, 12, 12, 100_000, 100_000, 100_000]
    assert found.is_lifted.tolist() == [True, True, False, False, True, False]
    assert found.numbers[:, 0].tolist() == [3, 12, 13, 100_000, 100_001, 100_002]
    assert found.images[:, 1].tolist() == [3, 12, 12, 160, 160, 160]
    some = found.of_stones(found.stone == 12)
    assert (some.stone.tolist(), some.is_lifted.tolist()) == ([12, 12], [True, False])
    assert (some.numbers[:, 0].tolist(), some.images[:, 0].tolist()) == ([12, 13], [12, 12])


@pytest.mark.parametrize(("rounded", "expected"), [(1.0, {"round"}), (0.0, {"block"})])
def test_stones_that_do_not_come_to_rest_are_drawn_anew(
    monkeypatch: pytest.MonkeyPatch, rounded: float, expected: set[str]
) -> None:
    """Its middle is above the origin, its bottom where it rests; sizes are drawn evenly."""
    corners, drawn, answers = np.array([[0.0, 0, 0], [2.0, 4, 6], [1.0, 1, 1]]), [], []
    T = pose(t=np.array([10.0, 20.0, 0.5]))

    def draw(kind: str):
        return lambda volume_m3, rng: drawn.append((kind, volume_m3)) or corners

    def at_rest(hull, rng):
        answers.append(None if len(answers) % 3 < 2 else T)
        return answers[-1]

    monkeypatch.setattr(labels, "rounded_stone", draw("round"))
    monkeypatch.setattr(labels, "block", draw("block"))
    monkeypatch.setattr(labels, "at_rest", at_rest)
    settings, rng = LabelSettings(rounded=rounded, volume_m3=(0.125, 8.0)), np.random.default_rng(1)
    for _ in range(100):
        lies = resting_stone(settings, rng)
    assert lies == pytest.approx(np.array([[-1.0, -2, 0.5], [1.0, 2, 6.5], [0.0, -1, 1.5]]))
    assert len(drawn) == 300
    assert {kind for kind, _ in drawn} == expected
    sizes_m = np.cbrt([volume_m3 for _, volume_m3 in drawn])
    assert 0.5 <= sizes_m.min() < 0.55
    assert 1.95 < sizes_m.max() <= 2.0
    assert sizes_m.mean() == pytest.approx(1.25, abs=0.1)  # four of its standard deviations
