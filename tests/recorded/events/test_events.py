"""The fields of each event, as journals hold them: names and defaults."""

from dataclasses import MISSING, fields

from executive.events.event import event_classes
from executive.journal import EVENT_MODULES


def default_of(field) -> object:
    if field.default is not MISSING:
        return repr(field.default)
    return "empty" if field.default_factory is not MISSING else "to be given"


def test_events(recorded) -> None:
    modules = {module.__name__ for module in EVENT_MODULES}
    recorded(
        {
            one.kind: {field.name: default_of(field) for field in fields(one)}
            for _, one in sorted(event_classes().items())
            if one.__module__ in modules
        }
    )
