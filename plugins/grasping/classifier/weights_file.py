"""Where the weights of a network are."""

from pathlib import Path

_SHIPPED = Path(__file__).parents[1] / "weights"


def weights_file(name: str) -> Path:
    """Return the file of shipped weights with a name, or else the name as a path."""
    shipped = _SHIPPED / f"m545_{name}.safetensors"
    return shipped if shipped.exists() else Path(name)
