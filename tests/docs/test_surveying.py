"""The page on surveying is true: its plugins are installed, its settings exist, its numbers are
those of the code.
"""

import re
from pathlib import Path

from executive_plugins.surveying.settings import ColmapSettings, SimulatedPhotographsSettings
from pydantic import BaseModel

from executive import registry

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "surveying.md").read_text(encoding="utf-8")


def has(settings: type[BaseModel], dotted: str) -> bool:
    first, _, rest = dotted.partition(".")
    field = settings.model_fields.get(first)
    return field is not None and (not rest or has(field.annotation, rest))  # type: ignore[arg-type]


def test_the_table_lists_the_plugins_that_there_are() -> None:
    listed = set(re.findall(r"^\| `(\w+)` \|", PAGE, re.M))
    assert listed == {one.name for one in registry.installed("surveying")}


def test_settings_of_the_page_exist() -> None:
    named = set(re.findall(r"`((?:motion|flight|depth)\.\w+|max_scale_error)`", PAGE))
    assert len(named) >= 5
    for dotted in named:
        assert has(SimulatedPhotographsSettings, dotted), dotted
    set_on_commands = set(re.findall(r"--set surveying\.(\w+)=", PAGE)) - {
        "plugin",
        "path",
        "folder",
    }
    assert all(has(ColmapSettings, name) for name in set_on_commands)


def test_numbers_of_the_page_are_the_defaults() -> None:
    settings = SimulatedPhotographsSettings()
    flight = settings.flight
    width, height = flight.size_px
    assert f"{flight.strips * flight.pictures} pictures of {width} × {height} pixels" in PAGE
    assert f"off by {flight.offset_m} m all together and {flight.noise_m} m each" in PAGE
    assert f"over a flight of {flight.size_m[0]:.0f} × {flight.size_m[1]:.0f} m" in PAGE
    assert f"grid of {100 * settings.voxel_m:.0f} cm" in PAGE
    assert f"within {settings.depth.tolerance:.1%}".replace("%", " %") in PAGE
    assert (settings.motion.neighbours, settings.depth.compared, settings.depth.confirmed_by) == (
        8,
        4,
        2,
    )


def test_its_pictures_are_there() -> None:
    for name in re.findall(r"\]\((images/[\w.]+)\)", PAGE):
        assert (ROOT / "docs" / name).is_file(), name
