"""Errors whose sentence lists the cure."""

import pytest

from executive.errors import (
    ConfigError,
    DataError,
    ExecutiveError,
    RobotError,
    ShapeError,
    UnknownPluginError,
    did_you_mean,
)


def test_a_near_word_is_suggested() -> None:
    assert did_you_mean("gicpp", ["gicp", "point_to_plane"]) == ". Did you mean 'gicp'?"


def test_without_a_near_word_all_are_listed_in_order() -> None:
    assert did_you_mean("xyz", ["sqlite", "gicp"]) == "; there is: gicp, sqlite"
    assert did_you_mean("xyz", []) == "; there is none"


def test_an_unknown_plugin_is_a_mistake_in_the_file_and_says_what_there_is() -> None:
    with pytest.raises(
        ConfigError, match=r"no registration plugin 'gicpp'\. Did you mean 'gicp'\?"
    ):
        raise UnknownPluginError("registration", "gicpp", ["gicp"])


@pytest.mark.parametrize("error", [ConfigError, DataError, RobotError, ShapeError])
def test_all_errors_have_one_root(error: type[Exception]) -> None:
    assert issubclass(error, ExecutiveError)
