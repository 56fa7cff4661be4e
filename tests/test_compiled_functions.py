"""Compiled functions are kept from run to run."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def compiled() -> Iterator[tuple[str, ast.FunctionDef]]:
    """Yield each function that numba compiles, with its place."""
    for folder in ("executive", "plugins"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            text = path.read_text(encoding="utf-8")
            if "njit" not in text:
                continue
            for node in ast.walk(ast.parse(text)):
                if isinstance(node, ast.FunctionDef) and any(
                    "njit" in ast.unparse(one) for one in node.decorator_list
                ):
                    yield f"{path.relative_to(ROOT)}:{node.name}", node


FOUND = dict(compiled())


def test_there_are_compiled_functions() -> None:
    assert len(FOUND) > 100


@pytest.mark.parametrize("place", FOUND)
def test_is_kept_and_found_again(place: str) -> None:
    """A default that is an array is another one in each process: numba's cache never finds it, and
    keeps one more function of it in each run.
    """
    function = FOUND[place]
    assert any("cache=True" in ast.unparse(one) for one in function.decorator_list)
    assert not [*function.args.defaults, *filter(None, function.args.kw_defaults)]
