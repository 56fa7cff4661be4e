"""Names that the library of behaviour trees, or the mission language, has taken."""

import pytest

from executive.tree.btcpp.names import is_taken, leaf_name, leaf_tag, tree_id


@pytest.mark.parametrize(
    ("name", "taken"), [("Sequence", True), ("Sleep", True), ("LoopUntil", True), ("Go", False)]
)
def test_a_taken_name_gets_an_underscore_and_loses_it_again(name: str, taken: bool) -> None:
    assert is_taken(name) is taken
    assert leaf_tag(name) == (f"{name}_" if taken else name)
    assert leaf_name(leaf_tag(name)) == name
    assert leaf_name(name) == name


def test_a_leaf_whose_own_name_ends_with_an_underscore_keeps_it() -> None:
    assert leaf_name("Go_") == "Go_"


def test_a_tree_is_called_like_no_node() -> None:
    leaves = frozenset({"Go"})
    found = [tree_id(name, leaves) for name in ("Go", "Sequence", "main")]
    assert found == ["Go_tree", "Sequence_tree", "main"]
