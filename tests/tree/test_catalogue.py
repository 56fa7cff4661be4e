"""What can be chosen: names without imports, and clear words for what cannot be used."""

from pathlib import Path
from typing import Any

import pytest

from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import succeeded
from executive.tree.catalogue import Catalogue, InstalledCatalogue, TableCatalogue
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.schema import mission_schema


class Broken(TableCatalogue):
    """Knows one more plugin and one more behaviour, which cannot be imported."""

    def plugin_names(self, capability: str) -> tuple[str, ...]:
        return (
            *super().plugin_names(capability),
            *(["broken"] if capability in ("robot", "behaviour") else []),
        )

    def _load(self, capability: str, name: str) -> Any:
        if name == "broken":
            raise ConfigError("cannot be loaded: no module named 'moon'")
        return super()._load(capability, name)


def test_installed_names_hold_what_this_package_announces() -> None:
    catalogue = InstalledCatalogue()
    assert "mujoco" in catalogue.plugin_names("robot")
    assert "ScanSwing" in catalogue.behaviour_names()
    assert catalogue.behaviour("ScanSwing").__name__ == "ScanSwing"


@pytest.mark.parametrize(
    "catalogue", [InstalledCatalogue(), TableCatalogue({"ScanSwing": Action}, {})]
)
def test_an_unknown_behaviour_is_told_with_the_nearest(catalogue: Catalogue) -> None:
    with pytest.raises(ConfigError, match=r"no behaviour 'ScanSwnig'\. Did you mean 'ScanSwing'\?"):
        catalogue.behaviour("ScanSwnig")


def test_a_class_of_another_kind_is_refused() -> None:
    catalogue = TableCatalogue({"Odd": Plugin}, {"robot": {"odd": Action}})  # type: ignore[dict-item]
    with pytest.raises(ConfigError, match="neither an Action nor a Condition"):
        catalogue.behaviour("Odd")
    with pytest.raises(ConfigError, match="is no Plugin"):
        catalogue.plugin("robot", "odd")


def test_what_cannot_be_imported_is_a_mistake_where_it_is_chosen_and_nowhere_else(
    tmp_path: Path,
) -> None:
    class Rest(Action):
        def run(self) -> Steps[None]:
            yield None
            return succeeded()

    catalogue = Broken({"Rest": Rest}, {"robot": {"fine": Plugin}, "estimation": {"fine": Plugin}})
    assert "cannot be loaded" in str(
        mission_schema(catalogue)["properties"]["plugins"]["properties"]["robot"]
    )
    path = tmp_path / "mission.yaml"
    text = (
        "api: 1\nmission: m\nplugins: {robot: fine, estimation: fine}\ntrees: {main: {run: Rest}}\n"
    )
    path.write_text(text)
    assert load_mission(str(path), catalogue=catalogue).name == "m"
    path.write_text(text.replace("robot: fine", "robot: broken").replace("Rest", "broken"))
    with pytest.raises(MissionFileError) as caught:
        load_mission(str(path), catalogue=catalogue)
    marks = [(problem.mark.line, problem.mark.column) for problem in caught.value.problems]
    assert marks == [(3, 18), (4, 21)]
