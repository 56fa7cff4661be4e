"""A world for the leaves of one test."""

import pytest

from tests.tree.composites.scripted_world import World


@pytest.fixture
def world() -> World:
    return World()
