"""Optional dependencies: the extras of a package, and what of an extra is not installed."""

from functools import cache
from importlib import metadata

from packaging.requirements import Requirement

from executive.errors import ConfigError


class MissingExtraError(ConfigError):
    """A plugin or a command needs packages that are installed only on request."""

    def __init__(
        self, who: str, extra: str, missing: tuple[str, ...], distribution: str, cure: str = ""
    ) -> None:
        super().__init__(
            f"{who} needs the extra '{extra}' (not installed: {', '.join(missing)}): "
            f'pip install "{distribution}[{extra}]"{cure}'
        )


def missing_packages(extra: str, distribution: str = "executive") -> tuple[str, ...]:
    """Return the packages of an extra that are not installed, sorted by name.

    Args:
        extra: Name of the extra, such as `learning`.
        distribution: The package that defines it.
    """
    return tuple(name for name in packages_of(extra, distribution) if not _is_installed(name))


@cache
def packages_of(extra: str, distribution: str) -> tuple[str, ...]:
    """Return the packages of an extra, sorted by name."""
    try:
        listed = metadata.requires(distribution) or ()
    except metadata.PackageNotFoundError:
        return ()
    wanted = (
        one
        for one in map(Requirement, listed)
        if one.marker and one.marker.evaluate({"extra": extra})
        if not one.marker.evaluate({"extra": ""})
    )
    return tuple(sorted({one.name for one in wanted}))


def require_extra(who: str, extra: str, distribution: str = "executive") -> None:
    """Refuse to go on without the packages of an extra.

    Raises:
        MissingExtraError: If one is not installed; the message says how to install it.
    """
    missing = missing_packages(extra, distribution)
    if missing:
        raise MissingExtraError(who, extra, missing, distribution)


def _is_installed(name: str) -> bool:
    try:
        metadata.distribution(name)
    except metadata.PackageNotFoundError:
        return False
    return True
