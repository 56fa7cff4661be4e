"""Regions of a mission: read with units, checked with places, used by leaves."""

from pathlib import Path

import numpy as np
import pytest

from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.resolved import resolved_yaml

MISSION = """\
api: 1
mission: regions
extends: base
regions:
  yard: {{box: [[2 m, -4 m], [800 cm, 4 m]]}}
  way: {{corridor: [[3 m, -6 m], [3 m, 6 m]], width: 3 m}}
  bank: {{polygon: [[0, 5], [2, 8], [4, 5]]}}
{more}trees:
  main:
    sequence:
      - check: NoStoneMatches
        with: {{{use}}}
"""


def load(tmp_path: Path, more: str = "", use: str = "touching: way"):
    path = tmp_path / "regions.yaml"
    path.write_text(MISSION.format(more=more, use=use))
    return load_mission(str(path))


def test_a_box_a_corridor_and_a_polygon_become_outlines(tmp_path):
    regions = load(tmp_path).regions
    np.testing.assert_allclose(regions["yard"].corners_map, [[2, -4], [8, -4], [8, 4], [2, 4]])
    assert sorted(map(tuple, regions["way"].corners_map)) == [
        (1.5, -6), (1.5, 6), (4.5, -6), (4.5, 6),
    ]  # fmt: skip
    assert regions["bank"].contains(np.array([[2.0, 6.0, 0.0], [2.0, 4.9, 0.0]])).tolist() == [
        True,
        False,
    ]


def test_a_corridor_with_a_bend_keeps_its_width(tmp_path):
    bent = load(tmp_path, "  bend: {corridor: [[0, 0], [4, 0], [4, 4]], width: 2 m}\n").regions[
        "bend"
    ]
    for x, y, is_inside in ((2, 0.9, 1), (2, 1.1, 0), (4.9, 2, 1), (5.1, 2, 0), (4.9, -0.9, 1)):
        assert bent.contains(np.array([[x, y]]))[0] == is_inside, (x, y)


def test_the_resolved_mission_has_the_same_regions(tmp_path):
    mission = load(tmp_path)
    again = tmp_path / "again.yaml"
    again.write_text(resolved_yaml(mission))
    regions = load_mission(str(again)).regions
    for name, region in mission.regions.items():
        np.testing.assert_allclose(regions[name].corners_map, region.corners_map)


@pytest.mark.parametrize(
    ("more", "use", "told"),
    [
        ("", "touching: wya", "12:26: error: 'touching' of NoStoneMatches: no region 'wya'"),
        ("  a: {box: [[0, 0], [1 t, 2]]}\n", "off: way", "8:22: error: box.1.0: 't' is not a unit"),
        ("  a: {boxx: 1}\n", "off: way", "8:7: error: region 'a' has no setting 'boxx'"),
        ("  a: {corridor: [[0, 0], [1, 0]]}\n", "off: way", "8:6: error: a corridor, and only a"),
        ("  a: {width: 1 m}\n", "off: way", "8:6: error: a region is one of polygon, box, corr"),
        (
            "  a: {corridor: [[0, 0], [4, 0], [0, 0.1]], width: 1 m}\n",
            "off: way",
            "8:6: error: region 'a': a corridor bends back on itself",
        ),
        (
            "  a: {polygon: [[0, 0], [1, 1], [1, 0], [0, 1]]}\n",
            "off: way",
            "8:6: error: region 'a' has an outline of 4 corners that crosses itself",
        ),
    ],
)
def test_a_mistake_is_told_at_its_place(tmp_path, more, use, told):
    with pytest.raises(MissionFileError) as raised:
        load(tmp_path, more, use)
    assert told in str(raised.value)


def test_a_name_that_is_nearly_right_is_proposed(tmp_path):
    with pytest.raises(MissionFileError, match="Did you mean 'way'"):
        load(tmp_path, use="touching: wya")


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("{chosen.mass} > 0.8 t", ""),
        ("{chosen.volume} > 300 l and {chosen.length} < 2 m", ""),
        ("{chosen.mass} > 0.8 m", "cannot compare a mass and a length"),
        ("{chosen.colour} > 1", "Stone has no field 'colour'"),
    ],
)
def test_fields_of_a_chosen_stone_are_compared_with_units(tmp_path, asked, told):
    path = tmp_path / "heavy.yaml"
    path.write_text(
        "api: 1\nmission: heavy\nextends: base\ntrees:\n  main:\n    sequence:\n"
        f'      - check: SelectStone\n      - check: "{asked}"\n'
    )
    if not told:
        load_mission(str(path))
        return
    with pytest.raises(MissionFileError, match=told):
        load_mission(str(path))
