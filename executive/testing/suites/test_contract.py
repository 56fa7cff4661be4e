"""The class of every plugin: its interface, its verbs, its constructor, what it declares."""

import inspect
import math

from executive import registry
from executive.interfaces.plugin import Plugin
from executive.testing.subject import Subject

SERVICES = ("machine", "rng")


def verbs_of(interface: type[Plugin]) -> list[str]:
    """Return the public methods of an interface, those of every plugin left out."""
    members = inspect.getmembers(interface, inspect.isfunction)
    return [name for name, _ in members if not name.startswith("_") and not hasattr(Plugin, name)]


def test_it_derives_from_the_interface_of_its_capability(subject: Subject) -> None:
    interface = registry.interface(subject.capability)
    assert issubclass(subject.plugin_class, interface), f"it must derive from {interface.__name__}"


def test_it_implements_every_verb(subject: Subject) -> None:
    missing = sorted(getattr(subject.plugin_class, "__abstractmethods__", ()))
    assert not missing, f"not implemented: {', '.join(missing)}"


def test_its_verbs_take_what_the_interface_says(subject: Subject) -> None:
    interface = registry.interface(subject.capability)
    for verb in (*verbs_of(interface), "start", "close"):
        wanted = list(inspect.signature(getattr(interface, verb)).parameters)
        taken = inspect.signature(getattr(subject.plugin_class, verb)).parameters
        assert list(taken)[: len(wanted)] == wanted, f"{verb} must take ({', '.join(wanted)})"
        more = [p for p in list(taken.values())[len(wanted) :] if p.default is p.empty]
        assert not [p for p in more if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)], (
            f"{verb} takes {', '.join(p.name for p in more)} without a default; the interface "
            f"gives ({', '.join(wanted)})"
        )


def test_it_says_what_it_does(subject: Subject) -> None:
    own = subject.plugin_class.__doc__
    assert own, "the class has no docstring; `executive plugins show` prints its first line"
    assert own.strip(), "the docstring is empty"


def test_it_asks_for_services_and_capabilities_only(subject: Subject) -> None:
    known = (*SERVICES, *registry.capabilities())
    unknown = [n for n in registry.dependencies_of(subject.plugin_class) if n not in known]
    assert not unknown, (
        f"the constructor asks for {', '.join(unknown)}; there is: {', '.join(known)}"
    )


def test_its_declared_latencies_are_those_of_its_verbs(subject: Subject) -> None:
    verbs = verbs_of(registry.interface(subject.capability))
    for verb, latency_s in subject.plugin_class.latency_s.items():
        assert verb in verbs, f"latency_s names '{verb}'; the verbs are {', '.join(verbs)}"
        assert math.isfinite(latency_s), f"latency_s['{verb}'] is not finite"
        assert latency_s >= 0, f"latency_s['{verb}'] is negative"
