"""What is installed where runs happen: results of two machines are compared only if it is equal."""

import hashlib
import platform
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from packaging.requirements import Requirement

from executive import registry

PACKAGES = ("executive", "executive_plugins", "executive_robot_models", "executive_trees")
# What an installation consists of; other files in a source tree, such as an editor's, do not count.
SUFFIXES = (".py", ".yaml", ".txt", ".safetensors")
# Extras whose packages have no influence on what a run computes.
TOOLS = ("all", "cluster", "dev", "docs", "groot", "reports", "testing", "viewing")


@dataclass(frozen=True, slots=True)
class Fingerprint:
    """The software that decides what a run computes.

    Attributes:
        version: Version of this package.
        sources: SHA-256 over the files of its installed folders, in hexadecimal digits.
        python: Version of Python without the last number, such as `3.11`.
        distributions: Version by name of the installed packages that this one depends on, and of
            those that bring plugins.
        plugins: What is installed with all that it needs, each as `capability.name`, such as
            `registration.kiss_matcher`, `work.mission` or `metric.success`.
    """

    version: str
    sources: str
    python: str
    distributions: Mapping[str, str]
    plugins: tuple[str, ...]


@cache
def local_fingerprint() -> Fingerprint:
    """Take the fingerprint of this process's installation; it is read from disk once."""
    major, minor, _ = platform.python_version_tuple()
    return Fingerprint(
        version=metadata.version("executive"),
        sources=_digest_of_sources(),
        python=f"{major}.{minor}",
        distributions=_distributions(),
        plugins=_plugins(),
    )


def differences(here: Fingerprint, there: Fingerprint) -> tuple[str, ...]:
    """List in words what differs so that results would not be comparable; empty if nothing does.

    A package that only one of the two has is no difference: a run that needs it refuses to begin
    where it is not installed.
    """
    pairs = [
        ("Python", here.python, there.python),
        ("version of executive", here.version, there.version),
        ("source files of executive (SHA-256)", here.sources[:12], there.sources[:12]),
        *(
            (f"version of {name}", version, there.distributions[name])
            for name, version in sorted(here.distributions.items())
            if name in there.distributions
        ),
    ]
    return tuple(
        f"{what} {theirs} instead of {ours}" for what, ours, theirs in pairs if ours != theirs
    )


def lacking(here: Fingerprint, there: Fingerprint) -> tuple[str, ...]:
    """List the plugins that can be used here and not there, such as for want of an extra."""
    return tuple(sorted(set(here.plugins) - set(there.plugins)))


def _digest_of_sources() -> str:
    digest = hashlib.sha256()
    for package in PACKAGES:
        for name, file in _files(package):
            digest.update(f"{package}/{name}\0{file.stat().st_size}\0".encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()


def _files(package: str) -> Iterator[tuple[str, Path]]:
    """Yield the files that an installation has, in order."""
    spec = find_spec(package)
    for root in sorted(spec.submodule_search_locations or () if spec else ()):
        for file in sorted(Path(root).rglob("*")):
            if file.suffix in SUFFIXES and file.is_file():
                yield file.relative_to(root).as_posix(), file


def _groups() -> tuple[str, ...]:
    """Return the groups of entry points in which packages announce plugins."""
    found = metadata.entry_points().groups
    return tuple(sorted(one for one in found if re.fullmatch(r"executive\.\w+\.v1", one)))


def _plugins() -> tuple[str, ...]:
    groups = [group.split(".")[1] for group in _groups()]
    found = (one for group in groups for one in registry.installed(group))
    return tuple(f"{one.capability}.{one.name}" for one in found if not one.missing_extra)


def _distributions() -> dict[str, str]:
    extras = set(metadata.metadata("executive").get_all("Provides-Extra") or ()) - set(TOOLS)
    requirements = map(Requirement, metadata.requires("executive") or ())
    names = {one.name for one in requirements if _is_of(one, extras)}
    points = (point for group in _groups() for point in metadata.entry_points(group=group))
    names |= {point.dist.name for point in points if point.dist}
    return {name: version for name in names - {"executive"} if (version := _version(name))}


def _is_of(requirement: Requirement, extras: set[str]) -> bool:
    """Return whether a requirement belongs to the package itself or to one of some extras."""
    marker = requirement.marker
    return marker is None or any(marker.evaluate({"extra": one}) for one in ("", *extras))


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""
