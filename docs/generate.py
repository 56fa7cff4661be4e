"""Write the pages that are generated from the code: the words of missions, the fields of
`robot.yaml`, the events of the journal, and the metrics of campaigns.

    python docs/generate.py

`tests/docs/test_generated.py` fails when a page is not what this script would write.
"""

import dataclasses
import inspect
import re
import types
import typing
from collections.abc import Iterator, Mapping
from enum import Enum
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from executive import registry
from executive.arrays import Float
from executive.config import UNITS
from executive.events.event import Event
from executive.journal import EVENT_MODULES
from executive.leaf.action import Action, Leaf
from executive.leaf.port import section
from executive.machine.gripper import Gripper, JawPart
from executive.machine.joint import Jaw, Joint
from executive.machine.link import Link
from executive.machine.machine import Machine, Stance
from executive.machine.sensor import Encoders, Gnss, Imu, Lidar
from executive.machine.shape import Shape
from executive.tree.node_reader import KINDS, MODIFIERS
from executive.tree.port_types import type_name

DOCS = Path(__file__).parent
HOW_TO = DOCS / "how-to" / "write_a_tree.md"
NOTE = "<!-- Written by docs/generate.py from the code. Do not edit. -->\n"
PROVENANCE = "source, or field → source"
WORDS = """\
# Words of missions

Every word that a mission file may use, read from what is installed. How they are put together:
[write a tree](how-to/write_a_tree.md). Plugins and their settings: `executive plugins list` and
`executive plugins show CAPABILITY NAME`.
"""
ACTIONS = """\
## Actions

`run:` these. They take time. A port that is not listed under `in:` or `out:` of the node is
connected to the key of its own name; `?` marks one that may be missing.
"""
CHECKS = """\
## Checks

`check:` these, or name them in a condition. They answer at once.
"""
EVENTS = """\
# Events of the journal

The kinds of events that the executive and its leaves write, with the fields of `payload`. In
Python, `executive.journal.read_journal` gives each back as its class of `executive/events`.
Packages may add kinds of their own; those are read back as `UnknownEvent` where the package is not
installed.
How to read a run: [read a run](how-to/read_a_run.md).
"""
ROBOT_YAML = """\
# A machine's robot.yaml

A machine is a folder with one file, `robot.yaml`: joints, links, sensors, gripper. URDF, MJCF,
kinematics, the self-filter and all limits are made from it. Two are shipped: `robot_models/m545`
(HEAP) and `robot_models/mini` (a generic machine of eight tonnes). For your own, copy one, change
it, and name its folder:

```sh
executive check map_site --set robot.model=robot_models/mini
```

SI units; frames as on the page of [conventions](conventions.md). An unknown field, a missing one
or a value out of bounds is refused, with its place. `provenance` says of each block where its
figures come from: `measured`, `paper` or `guess`. Most efforts, accelerations and masses of the
shipped machines are guesses.

Not described: hydraulics, tipping, a load chart by radius, and the motion of the wheels. Every
machine has one chain of joints from the base to a gripper with two mirrored jaws.
"""
METRICS = """\
# Metrics and statistics of campaigns

What a campaign can measure on each run, read from what is installed, and how the figures over many
runs come about. A package adds a metric by a class that derives from
`executive.interfaces.metric.Metric` and an entry point in the group `executive.metric.v1`; a metric
reads a run's report and journal ([read a run](how-to/read_a_run.md)). One that raises an error
costs that run this one measurement: the report of the campaign counts such runs and says where the
error was raised.

A **share** counts hits out of trials in each run: stones of a site, attempts, or the run itself.
**Values** are any number of measurements in each run. "Truth" is what the simulator knows, so that
metrics by the truth are for simulated runs only.

A metric of your own, here over an event that a leaf of your own records
([write a tree](how-to/write_a_tree.md)):

```python
from executive.interfaces.metric import Metric, RunRecord, Values

from my_package.events import StoneWeighed


class Weight(Metric):
    title = "mass of a stone"
    unit = "kg"
    description = "Mass of each stone that was weighed."

    def measure(self, run: RunRecord) -> Values | None:
        weighed = [one.event for one in run.events if isinstance(one.event, StoneWeighed)]
        return Values(tuple(event.mass_kg for event in weighed)) if weighed else None
```

```toml
[project.entry-points."executive.metric.v1"]
weight = "my_package.metrics:Weight"
```
"""
STATISTICS = """\
## Statistics

All intervals are of 95 %. What they claim is simulated in
`tests/campaign/figures/test_coverage.py`.

**Nothing is left out.** A run that crashed, was killed or exceeded a limit counts in every share as
the worst: no hit where more is better. How many trials it would have had is taken from a run with
the same seed in another cell, or else from the median of its cell, and the estimate says how many
trials were assumed so. A run that a fault ended counts so in the shares that it could not measure.
Such runs have no values: read the values beside `success`.

**A share of runs** has Wilson's score interval (Wilson 1927).

**A share counted inside runs**, such as `placed`, has Wilson's interval with the effective number
of trials, because the stones of one site resemble each other (Korn & Graubard 1998; Dean & Pagano
2015). It is never narrower than the interval of independent trials.

**Values** are told by their median and their tails: `p90`, `p95`, `max`, `min`. An interval lies
between two of the measured values, whose ranks follow from the binomial distribution, with the
effective number of values where several come from one run (Woodruff 1952). This holds for any
distribution. The bootstrap was tried and does not hold for tails of few runs: resampled values
never exceed the largest one measured, and of a 95th percentile from 20 runs the interval contained
the true one 61 times out of 100, not 95. Where so few runs bound a figure on one side only, the
other end is left open.

**Differences** between a level and its baseline are taken on the same seeds. For shares the
interval is Newcombe's for paired proportions (Newcombe 1998, method 10), extended to shares inside
runs by joining their intervals (Zou & Donner 2008). For values it is that of the median, over
seeds, of the difference between the medians of the two runs. `better` and `worse` are numbers of
seeds, the discordant pairs; the p-value is that of the exact sign test on them, which for shares of
runs is McNemar's. The verdict is one of these:

- `alike`: the whole interval is within the margin of the comparison, so that there is no difference
  that matters.
- `better`, `worse`: the whole interval is on one side of zero. For values also where the sign test
  on the seeds that differ by more than the margin tells a direction, though the median does not:
  more than half of all runs may have no collision at all.
- `too_few`: neither. The number of seeds that would probably tell is given: for a power of 80 %, if
  further seeds are like those seen.

Each verdict stands for itself: of twenty comparisons of variants that are equal, one is told as
better or worse by chance. Decide before the campaign which comparison counts.

With a true difference of 10 points on 100 paired seeds, `worse` is told for `success` with a
probability of 98 % where no seed improves and 10 of 100 get worse, of 80 % with 2 against 12, and
of 60 % with 5 against 15. For `placed`, with seven stones a site, it is told with more than 95 %,
and on 50 seeds with 83 % to 95 %.

**A bound** is met if the figure is within it. It is sure if the whole interval is.
"""
SENSORS = """\
## sensors

A mapping from the sensor's name. `kind` selects the fields.
"""


def pages() -> dict[Path, str]:
    """Return the generated pages."""
    return {
        DOCS / "words.md": words_page(),
        DOCS / "robot_yaml.md": robot_yaml_page(),
        DOCS / "journal_events.md": events_page(),
        DOCS / "metrics.md": metrics_page(),
    }


def words_page() -> str:
    """Return the page of all words of a mission file."""
    leaves = {
        one.name: registry.load(registry.BEHAVIOURS, one.name)
        for one in registry.installed(registry.BEHAVIOURS)
        if one.distribution == "executive"
    }
    actions = {name: leaf for name, leaf in leaves.items() if issubclass(leaf, Action)}
    checks = {name: leaf for name, leaf in leaves.items() if name not in actions}
    parts = [
        WORDS,
        "## Kinds of nodes\n",
        *_kinds(),
        "## Modifiers\n",
        *_modifiers(),
        "## Units\n",
        *_units(),
        ACTIONS,
        *(line for name, leaf in sorted(actions.items()) for line in _leaf(name, leaf)),
        CHECKS,
        *(line for name, leaf in sorted(checks.items()) for line in _leaf(name, leaf)),
    ]
    return "\n".join([NOTE, *parts])


def _kinds() -> Iterator[str]:
    meanings = _meanings()
    yield "| kind | keys beside it | what it does |"
    yield "|---|---|---|"
    for kind, keys in KINDS.items():
        beside = ", ".join(f"`{key}`" for key in keys) or "–"
        yield f"| `{kind}` | {beside} | {meanings[kind]} |"
    yield ""


def _modifiers() -> Iterator[str]:
    meanings = _meanings()
    yield "They are applied in this order, the first outermost.\n"
    yield "| modifier | what it does |"
    yield "|---|---|"
    for modifier in MODIFIERS:
        yield f"| `{modifier}` | {meanings[modifier]} |"
    yield ""


def _meanings() -> dict[str, str]:
    """Return what each kind and modifier does, from the tables of the page on trees."""
    rows = re.findall(r"^\| `(\w+).*?` (?:[^|]*)\| (.*) \|$", HOW_TO.read_text("utf-8"), re.M)
    return dict(rows)


def _units() -> Iterator[str]:
    yield "| quantity | units; a plain number is in the first |"
    yield "|---|---|"
    for dimension, units in UNITS.items():
        yield f"| {dimension} | {', '.join(f'`{unit}`' for unit in units)} |"
    yield ""


def _leaf(name: str, leaf: type[Leaf]) -> Iterator[str]:
    yield f"### {name}\n"
    yield f"{_first_line(leaf)}\n"
    if leaf.needs:
        needs = [getattr(need, "capability", need) for need in leaf.needs]
        yield f"Needs plugins for: {', '.join(needs)}.\n"
    rows = [
        *(("in", port, spec) for port, spec in leaf.inputs.items()),
        *(("out", port, spec) for port, spec in leaf.outputs.items()),
    ]
    fields = leaf.Settings.model_fields
    if rows or fields:
        yield "| | name | type or default | meaning |"
        yield "|---|---|---|---|"
    for way, port, spec in rows:
        kind = f"{type_name(spec.type)}{'?' * spec.optional}"
        yield f"| {way} | `{port}` | `{kind}` | {_cell(spec.doc)} |"
    for field, info in fields.items():
        yield f"| with | `{field}` | {_default(info)} | {_cell(info.description or '')} |"
    if rows or fields:
        yield ""


def robot_yaml_page() -> str:
    """Return the page of all fields of a machine's file."""
    parts = [
        ROBOT_YAML,
        *_block("The file", Machine, "The top level."),
        *_block("stance", Stance),
        *_block("joints", Joint, "A list, from the base to the gripper; each carries the next."),
        *_block("jaw", Jaw),
        *_block("gripper", Gripper),
        *_block("gripper.jaw_parts", JawPart, "A list."),
        *_block("bodies", Link, "A mapping from the link's name. Without the gripper's links."),
        *_block("shapes", Shape, "A list, in a body or in `gripper.palm_shapes`."),
        SENSORS,
        *_block("sensors, kind: lidar", Lidar),
        *_block("sensors, kind: imu", Imu),
        *_block("sensors, kind: gnss", Gnss),
        *_block("sensors, kind: encoders", Encoders),
    ]
    return "\n".join([NOTE, *parts])


def events_page() -> str:
    """Return the page of all events of the journal."""
    parts = [EVENTS]
    for module in EVENT_MODULES:
        parts += [
            f"## {module.__name__.rpartition('.')[2].capitalize()}\n",
            f"{_first_line(module)}\n",
        ]
        parts += [line for event in _events_of(module) for line in _event(event)]
    return "\n".join([NOTE, *parts])


def _events_of(module: types.ModuleType) -> list[type[Event]]:
    return [
        one
        for one in vars(module).values()
        if inspect.isclass(one) and issubclass(one, Event) and one.__module__ == module.__name__
    ]


def _event(event: type[Event]) -> Iterator[str]:
    yield f"### {event.kind}\n"
    yield f"{_first_line(event)}\n"
    meanings = section(event.__doc__, "Attributes")
    kinds = typing.get_type_hints(event)
    rows = [(one.name, kinds[one.name]) for one in dataclasses.fields(event)]
    if rows and not meanings:
        yield f"Fields: {', '.join(f'`{name}` ({_type(kind)})' for name, kind in rows)}.\n"
    elif rows:
        yield "| field | type | meaning |"
        yield "|---|---|---|"
        for name, kind in rows:
            yield f"| `{name}` | {_type(kind)} | {_cell(meanings.get(name, ''))} |"
        yield ""
    for name, kind in rows:
        for part in (kind, *typing.get_args(kind)):
            if dataclasses.is_dataclass(part):
                fields = ", ".join(f"`{one.name}`" for one in dataclasses.fields(part))
                yield f"`{name}` holds {fields}. {_first_line(part)}\n"


def metrics_page() -> str:
    """Return the page of all metrics, in the order in which the package announces them."""
    rows = ["| metric | what it measures | kind | better | definition |", "|---|---|---|---|---|"]
    for point in entry_points(group=f"executive.{registry.METRICS}.v1"):
        metric = point.load()
        if not metric.__module__.startswith("executive."):
            continue
        unit = f" [{metric.unit}]" if metric.unit else ""
        kind = "share" if metric.is_share else f"values{unit}"
        better = "more" if metric.is_more_better else "less"
        definition = _cell(metric.description)
        rows.append(f"| `{point.name}` | {metric.title} | {kind} | {better} | {definition} |")
    return "\n".join([NOTE, METRICS, "## Metrics\n", *rows, "", STATISTICS])


def _block(title: str, model: type[BaseModel], introduction: str = "") -> Iterator[str]:
    yield f"## {title}\n"
    yield f"{introduction} {_first_line(model)}".strip() + "\n"
    yield "| field | type | default | bounds | meaning |"
    yield "|---|---|---|---|---|"
    for name, info in model.model_fields.items():
        if name == "name" and model in (Link, Lidar, Imu, Gnss, Encoders):
            continue  # the key of the mapping
        kind = PROVENANCE if name == "provenance" else _type(info.annotation)
        meaning = _cell(info.description or _first_line(info.annotation))
        yield f"| `{name}` | {kind} | {_default(info)} | {_bounds(info)} | {meaning} |"
    yield ""


def _type(kind: Any) -> str:
    origin, given = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Annotated:
        return _type(given[0])
    if origin is typing.Literal:
        return " or ".join(f"`{one}`" for one in given)
    if origin in (typing.Union, types.UnionType):
        return " or ".join(_type(one) for one in given if one is not type(None))
    if origin is tuple:
        if given[-1] is Ellipsis:
            return f"list of {_type(given[0])}"
        return f"[{', '.join(_type(one) for one in given)}]"
    if origin in (dict, Mapping):
        return f"{_type(given[0])} → {_type(given[1])}"
    if kind == Float:
        return "numbers"
    if inspect.isclass(kind) and issubclass(kind, Enum):
        return " or ".join(f"`{one.value}`" for one in kind)
    names = {float: "number", int: "whole number", str: "text", bool: "true or false"}
    return names.get(kind) or kind.__name__.lower()


def _default(info: FieldInfo) -> str:
    if info.is_required():
        return "required"
    value = info.get_default(call_default_factory=True)
    return "–" if value is None else f"`{list(value) if isinstance(value, tuple) else value}`"


def _bounds(info: FieldInfo) -> str:
    signs = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}
    found = []
    for constraint in info.metadata:
        for key, sign in signs.items():
            if getattr(constraint, key, None) is not None:
                found.append(f"{sign} {getattr(constraint, key):.4g}")
        if getattr(constraint, "min_length", None):
            found.append(f"at least {constraint.min_length}")
    return ", ".join(found) or "–"


def _first_line(thing: Any) -> str:
    has_text = inspect.isclass(thing) or inspect.ismodule(thing)
    text = inspect.getdoc(thing) if has_text else None
    paragraph = (text or "").partition("\n\n")[0]
    return _cell(" ".join(paragraph.split()))


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


if __name__ == "__main__":
    for path, text in pages().items():
        path.write_text(text, encoding="utf-8")
        print(path)
