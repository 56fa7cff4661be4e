"""Options of the command line, laid over a campaign file or over a mission."""

import re
from dataclasses import dataclass

from executive.tree.override import option_value, parsed_option
from executive.tree.problem import Mark, one_line
from executive.tree.reading import Reading
from executive.tree.scalar import Plain
from executive.tree.sources import API
from executive.tree.value import Listing, Scalar, Table, TableEntry, Value


@dataclass(frozen=True, slots=True)
class CampaignOptions:
    """What the command line says of a campaign.

    Attributes:
        seeds: `1:20`, `7`, or several of them with commas; the file's own if None.
        settings: `capability.field=value`, for every run.
        vary: `capability.field=a,b,c`: a factor with its values as levels.
        time_limit: Limit of a run, such as `20 min`.
        memory_limit: Limit of a run, such as `4 GB`.
    """

    seeds: str | None = None
    settings: tuple[str, ...] = ()
    vary: tuple[str, ...] = ()
    time_limit: str | None = None
    memory_limit: str | None = None

    def laid_over(self, table: Table, reading: Reading) -> Table:
        """Return a campaign's table with the options in it; mistakes name the option."""
        if self.seeds is not None:
            table = _with(table, "seeds", _seeds(self.seeds))
        for option in self.settings:
            setting = parsed_option(option, reading)
            if setting is not None:
                table = _within(table, "set", setting.key, setting.value)
        for option in self.vary:
            factor = _factor(option, reading)
            if factor is not None:
                table = _within(table, "factors", *factor)
        for name in ("time", "memory"):
            text = getattr(self, f"{name}_limit")
            if text is not None:
                mark = Mark(one_line(f"--{name}-limit {text}"))
                value = option_value(text, mark, reading)
                table = table if value is None else _within(table, "limits", name, value)
        return table


def campaign_of(mission: str) -> Table:
    """Return the campaign of one mission, as a file would say it."""
    mark = Mark(mission)
    name = re.sub(r"\W", "_", mission.rpartition("/")[2].removesuffix(".yaml"))
    values: dict[str, Plain] = {
        "api": API,
        "campaign": name if name[:1].isalpha() else f"mission_{name}",
        "missions": mission,
    }
    return Table({k: TableEntry(mark, Scalar(v, mark)) for k, v in values.items()}, mark)


def _seeds(text: str) -> Value:
    mark = Mark(one_line(f"--seeds {text}"))
    parts = [part.strip() for part in text.split(",")]
    items = (Scalar(int(part) if part.isdecimal() else part, mark) for part in parts)
    return Listing(tuple(items), mark)


def _factor(option: str, reading: Reading) -> tuple[str, Value] | None:
    mark = Mark(one_line(f"--vary {option}"))
    key, equals, text = option.partition("=")
    if not equals or not text.strip():
        reading.problems.error(mark, "expected capability.field=a,b,c")
        return None
    value = option_value(f"[{text}]", mark, reading)
    return None if value is None else (key.strip(), value)


def _with(table: Table, key: str, value: Value) -> Table:
    return Table({**table.entries, key: TableEntry(value.mark, value)}, table.mark)


def _within(table: Table, section: str, key: str, value: Value) -> Table:
    """Put a value into a section, which is left as it is if it is no mapping."""
    known = table.get(section)
    if known is not None and not isinstance(known, Table):
        return table
    inner = known or Table({}, value.mark)
    entry = TableEntry(inner.mark, _with(inner, key, value))
    return Table({**table.entries, section: entry}, table.mark)
