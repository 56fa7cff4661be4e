"""A cloud that is no site in metres is recognised by its size, its steps or its partner, and its
unit is named.
"""

from pathlib import Path

import numpy as np
import pytest

from executive.clouds.units import check_site, unit_hint
from executive.errors import DataError

SITE = np.random.default_rng(1).uniform(0, 8, (2000, 3)) * [1, 1, 0.1]
PATH = Path("site.ply")
UTM = np.array([412_000.0, 5_246_000.0, 440.0])


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (SITE * 1000, "in millimetres it would be 8 m"),
        (SITE * 1000 + UTM * 1000, "in millimetres it would be 8 m"),
        (
            SITE * 100,
            r"in millimetres it would be 0.8 m: scale it by 0.001, in centimetres it would be 8",
        ),
        (SITE * 1e6, "crop it"),
        (SITE / 1000, r"0.008 m across is too small for a site .* is its unit the metre"),
        (SITE * [1e-5, 1e-5, 1] + [8.5, 47.4, 440], "x and y look like degrees; project it"),
        (np.ones((500, 3)), "0 m across is too small for a site"),
        (
            np.vstack([SITE, [[9e4, 0, 0]], [[0, 9e4, 0]]]),
            "without 2 points far away it is 7.8\\d* across: crop them",
        ),
    ],
)
def test_what_is_no_site_in_metres_is_named(points: np.ndarray, words: str) -> None:
    with pytest.raises(DataError, match=rf"site\.ply: .*{words}"):
        check_site(PATH, points)


def test_single_precision_so_far_out_is_too_coarse() -> None:
    rounded = (SITE + UTM).astype(np.float32).astype(float)
    with pytest.raises(DataError, match=r"in steps of 0\.5 m, because single precision"):
        check_site(PATH, rounded)


def test_six_digits_so_far_out_are_too_few() -> None:
    with pytest.raises(DataError, match=r"in steps of 10 m, .*few digits"):
        check_site(
            PATH, np.array([[float(f"{x:.6g}") for x in point] for point in 10 * SITE + UTM])
        )


@pytest.mark.parametrize(
    "points",
    [
        SITE,
        SITE + UTM,
        (SITE + [5000, 9000, 400]).astype(np.float32).astype(float),  # steps of a millimetre
        np.round(SITE + UTM, 2),  # a scale of a centimetre is usual in LAS files
        SITE[:20] + UTM,
        SITE[:1] + [[0, 0, 0], [1, 0, 0]],
        np.round(SITE, 1),  # a voxel grid about its own origin
    ],
)
def test_a_site_in_metres_passes(points: np.ndarray) -> None:
    check_site(PATH, points)


@pytest.mark.parametrize(
    ("factor", "unit"), [(1 / 0.3048, "feet"), (1000, "millimetres"), (100, "centimetres")]
)
def test_a_partner_tells_the_unit(factor: float, unit: str) -> None:
    assert unit_hint(factor * SITE, 1.05 * SITE).startswith("the source is")
    assert unit_hint(SITE, factor * SITE).endswith(f"is it in {unit}?")
    assert unit_hint(SITE, 1.05 * SITE) == ""
