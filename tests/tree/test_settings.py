"""Settings of a file against a class: exact types, and each mistake where it stands."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from pydantic import Field, model_validator

from executive.config import Meters, Radians, Settings
from executive.tree.document import read_text
from executive.tree.problem import Problems
from executive.tree.settings import check_settings, settings_dump
from executive.tree.value import Table


class Colour(StrEnum):
    RED = "red"


class Camera(Settings):
    name: str
    height_m: Meters = Field(1.0, gt=0)
    turn: Annotated[Radians, Field(le=7)] | None = None
    lens: int = Field(1, ge=1)


class Box(Settings):
    kind: Literal["box"] = "box"
    size: float


class Ball(Settings):
    kind: Literal["ball"] = "ball"
    radius: float


class All(Settings):
    cameras: tuple[Camera, ...] = ()
    camera: Camera | None = None
    colour: Colour = Colour.RED
    folder: Path | None = None
    limits: dict[str, float] = Field(default_factory=dict)
    shape: Box | Ball | None = Field(None, discriminator="kind")
    number: int | Literal["auto"] = "auto"
    line_m: tuple[tuple[Meters, Meters], ...] = Field(((0.0, 0.0), (1.0, 0.0)), min_length=2)
    low: float = 0.0
    high: float = 1.0

    @model_validator(mode="after")
    def _ordered(self) -> "All":
        if self.low > self.high:
            raise ValueError("low must not be above high")
        return self


def check(text: str) -> tuple[All | None, list[str]]:
    problems = Problems()
    table = read_text(text, "f", problems)
    assert isinstance(table, Table)
    return check_settings(All, table, "it", problems), [str(problem) for problem in problems.all()]


@pytest.mark.parametrize(
    "text",
    [
        "cameras: [{name: a, height_m: 20 cm}, {name: b}]",
        "camera: {name: a}",
        "colour: red",
        "folder: /tmp/x",
        "limits: {a: 1, b: 2.5}",
        "shape: {kind: ball, radius: 3}",
        "number: 3",
        "number: auto",
        "{}",
    ],
)
def test_good_settings_are_taken_and_come_back_when_written_out(text: str) -> None:
    checked, problems = check(text)
    assert problems == []
    assert checked is not None
    assert All.model_validate(settings_dump(checked)) == checked


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("cameras: [{name: a}, {nam: b}]", ["f:1:22: error: it needs the setting 'cameras.1.name'",
         "f:1:23: error: it has no setting 'cameras.1.nam'. Did you mean 'name'?"]),
        ("cameras:\n  - {name: a, height_m: 0}",
         ["f:2:25: error: cameras.0.height_m: input should be greater than 0, got 0"]),
        ("camera: {name: 3}", ["f:1:16: error: camera.name: input should be a valid string, got "
"3"]),
        ("camera: {name: a, heigth_m: 3}",
         ["f:1:19: error: it has no setting 'camera.heigth_m'. Did you mean 'height_m'?"]),
        ("colour: blue", ["f:1:9: error: colour: input should be 'red', got 'blue'"]),
        ("limits: {a: b}", ["f:1:13: error: limits.a: input should be a valid number, got 'b'"]),
        ("shape: {kind: ball, radius: wide}",
         ["f:1:29: error: shape.radius: input should be a valid number, got 'wide'"]),
        ("number: some", ["f:1:9: error: number: input should be a valid integer, got 'some'"]),
        ("low: .inf", ["f:1:6: error: low: input should be a finite number, got inf"]),
        ("low: true", ["f:1:6: error: low: input should be a valid number, got true"]),
        ("low: '1'", ["f:1:6: error: low: input should be a valid number, got '1'"]),
        ("line_m: [[1, 2], [3 ft, 4]]", ["f:1:19: error: line_m.1.0: 'ft' is not a unit of length; "
         "expected a length (a number in m, or with a unit: m, cm, mm, km), got '3 ft'"]),
        ("line_m: [[1, 2]]", ["f:1:9: error: line_m: tuple should have at least 2 items after "
         "validation, not 1, got a list"]),
        ("low: 3", ["f:1:1: error: low must not be above high"]),
    ],
)  # fmt: skip
def test_a_mistake_is_told_once_where_it_stands(text: str, told: list[str]) -> None:
    checked, problems = check(text)
    assert checked is None
    assert problems == told


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "turn: 120",
            "turn: input should be less than or equal to 7, got 120; expected an angle (a number "
            "in rad, or with a unit: rad, deg)",
        ),
        (
            "height_m: -3",
            "height_m: input should be greater than 0, got -3; expected a length (a number in m, "
            "or with a unit: m, cm, mm, km)",
        ),
        ("turn: 900 deg", "turn: input should be less than or equal to 7, got '900 deg'"),
        ("height_m: 0", "height_m: input should be greater than 0, got 0"),
        ("lens: -1", "lens: input should be greater than or equal to 1, got -1"),
    ],
)
def test_a_number_out_of_bounds_is_told_its_unit(text: str, told: str) -> None:
    """A person who writes 120 for an angle means degrees."""
    for wrapped in (f"camera: {{name: a, {text}}}", f"cameras: [{{name: a, {text}}}]"):
        _, (problem,) = check(wrapped)
        assert problem.partition("camera.")[2] == told or problem.partition("cameras.0.")[2] == told


def test_what_could_not_be_read_is_not_told_twice() -> None:
    problems = Problems()
    table = read_text("low: yes\nhigh: many\n", "f", problems)
    assert isinstance(table, Table)
    assert check_settings(All, table, "it", problems) is None
    told: list[Any] = [problem.mark.line for problem in problems.all()]
    assert told == [1, 2]
