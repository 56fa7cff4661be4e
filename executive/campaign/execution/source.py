"""Which software made the results: the version and a fingerprint of the installed sources."""

from functools import cache
from hashlib import sha256
from importlib import metadata, util
from pathlib import Path

_PACKAGES = ("executive", "executive_plugins", "executive_robot_models", "executive_trees")


def version() -> str:
    """Return the version of this package."""
    return metadata.version("executive")


@cache
def source_fingerprint() -> str:
    """Return a hash over the sources and data of this package, as they are installed here."""
    total = sha256()
    for package in _PACKAGES:
        for folder in _folders(package):
            for path in sorted(folder.rglob("*")):
                if path.suffix in (".py", ".yaml", ".safetensors"):
                    total.update(str(path.relative_to(folder)).encode())
                    total.update(path.read_bytes())
    return total.hexdigest()[:16]


def _folders(package: str) -> list[Path]:
    found = util.find_spec(package)
    return [Path(place) for place in (found.submodule_search_locations or ())] if found else []
