"""The JSON schema of campaign files, for completion in editors; built from what is installed.

It says what an editor can know: keys, names of plugins, settings and metrics, and their bounds.
What needs the whole campaign, such as levels that a bound is for, is told by `executive campaign`.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from executive import registry
from executive.campaign.description.comparisons import KEYS as COMPARISON_KEYS
from executive.campaign.description.comparisons import MARGIN
from executive.campaign.description.factors import MISSION
from executive.campaign.description.limits import DEFAULT
from executive.campaign.description.metrics import (
    EXCEPT,
    LIMITS,
    OF_VALUES,
    WHERE,
    installed_metrics,
)
from executive.campaign.figures.measurement import metric
from executive.errors import ConfigError
from executive.tree.catalogue import Catalogue
from executive.tree.override import LOOP
from executive.tree.schema import mission_schema
from executive.tree.sources import API, shipped_names

Schema = dict[str, Any]
_TEXT: Schema = {"type": "string"}
_LEVEL: Schema = {"type": ["string", "number", "boolean"]}
_QUANTITY: Schema = {"type": ["number", "string"]}
_SHARE: Schema = {
    "anyOf": [
        {"type": "number", "minimum": 0, "maximum": 1},
        {"type": "string", "pattern": "%\\s*$"},
    ],
    "description": "A share: 0.95 or 95 %.",
}
_FIGURE: Schema = {
    "type": "string",
    "pattern": r"^figure\.\w+$",
    "description": "A figure that the mission reports by ReportFigure.",
}
_SEED: Schema = {
    "anyOf": [
        {"type": "integer", "minimum": 0},
        {"type": "string", "pattern": r"^\s*\d+:\d+\s*$"},
    ],
    "description": "A seed, or a range such as 2001:2020 whose last seed is included; "
    "quote a range that ends below 60.",
}
_DESCRIPTIONS = {
    "campaign": "The campaign's name.",
    "description": "What it answers, in a sentence.",
    "arguments": "Arguments that all runs of another work share.",
    "missions": "Files, relative to this one, or names of shipped missions.",
    "set": "Settings of every run, as with --set.",
    "answers": "Answers to the missions' questions, as with --answer, true for yes.",
    "factors": "What is varied: every combination of levels is run with every seed.",
    "variants": "Instead of factors: names of variants, each with its settings.",
    "metrics": "What is reported, with bounds; all installed metrics if absent.",
    "compare": "What is compared with what; every factor with its first level if absent.",
}


def campaign_schema(catalogue: Catalogue | None = None) -> Schema:
    """Return the schema (draft 2020-12); what cannot be imported takes any settings."""
    mission = mission_schema(catalogue)
    settings = _settings(mission)
    mission_of_level = {MISSION: _mission()}
    levels: Schema = {"anyOf": [{"type": "null"}, {"$ref": "#/$defs/level"}]}
    named: Schema = {"type": "object", "additionalProperties": levels, "minProperties": 1}
    factors: Schema = {
        "type": "object",
        "properties": {key: {"anyOf": [named, _values(key)]} for key in settings},
        "additionalProperties": {"anyOf": [named, _any_values(_LEVEL)]},
    }
    properties: Schema = {
        "api": {"const": API, "description": "Version of the language of campaigns."},
        "campaign": {"type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_]*$"},
        "description": _TEXT,
        "work": {"enum": list(registry.names(registry.WORKS))},
        "arguments": {"type": "object"},
        "missions": _one_or_more(_mission()),
        "seeds": _one_or_more(_SEED),
        "set": {"$ref": "#/$defs/settings"},
        "answers": {"type": "array", "items": {"type": ["string", "boolean"]}, "minItems": 1},
        "factors": factors,
        "variants": named,
        "limits": _limits(),
        "metrics": _metrics(),
        "compare": {"type": "array", "items": _comparison()},
    }
    for key, description in _DESCRIPTIONS.items():
        properties[key] = {**properties[key], "description": description}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A campaign",
        **_closed(properties, "api", "campaign"),
        "$defs": {
            **mission["$defs"],
            "settings": {"type": "object", "properties": settings},
            "level": {"type": "object", "properties": {**settings, **mission_of_level}},
        },
    }


# --- settings


def _settings(mission: Schema) -> Schema:
    """Return every setting of every plugin by its dotted key, such as `robot.site.stones.count`."""
    found: Schema = dict(_fields(LOOP, mission["properties"][LOOP], mission["$defs"]))
    for capability, forms in mission["properties"]["plugins"]["properties"].items():
        found[capability] = forms
        names: list[str] = []
        for plugin in forms["anyOf"]:
            own = plugin.get("properties", {})
            if "plugin" in own:
                names.append(own["plugin"]["const"])
                _join(found, dict(_fields(capability, plugin, mission["$defs"])))
        found[f"{capability}.plugin"] = {"enum": names}
    return found


def _join(found: Schema, more: Mapping[str, Schema]) -> None:
    """Add the settings of a plugin; another plugin may have one of the same name."""
    for key, schema in more.items():
        known = found.get(key)
        if known is None:
            found[key] = schema
        elif known != schema:
            forms = known["anyOf"] if known.keys() == {"anyOf"} else [known]
            found[key] = {"anyOf": [*forms, schema]}


def _fields(prefix: str, owner: Schema, defs: Schema) -> Iterator[tuple[str, Schema]]:
    for name, schema in owner.get("properties", {}).items():
        yield f"{prefix}.{name}", schema
        reference = schema.get("$ref", "").removeprefix("#/$defs/")
        yield from _fields(f"{prefix}.{name}", defs.get(reference, {}), defs)


def _values(key: str) -> Schema:
    return _any_values({"$ref": f"#/$defs/settings/properties/{key}"})


def _any_values(schema: Schema) -> Schema:
    return {"type": "array", "items": schema, "minItems": 1}


# --- other sections


def _mission() -> Schema:
    return {"anyOf": [{"enum": list(shipped_names())}, _TEXT]}


def _limits() -> Schema:
    minutes, gigabytes = DEFAULT.time_s / 60, DEFAULT.memory_bytes / 1e9
    return _closed(
        {
            "time": {**_QUANTITY, "description": f"Of a run: 20 min; {minutes:.0f} min if absent."},
            "memory": {**_QUANTITY, "description": f"Of a run; {gigabytes:.0f} GB if absent."},
        }
    )


def _metrics() -> Schema:
    known = {}
    levels: Schema = {"type": "object", "additionalProperties": _LEVEL}
    cells = {WHERE: levels, EXCEPT: levels}
    for name in installed_metrics():
        try:
            measured = metric(name)
        except ConfigError:  # a broken one must not keep the editor from knowing the others
            continue
        limits = dict.fromkeys(LIMITS, _SHARE if measured.is_share else _QUANTITY)
        bounds = limits if measured.is_share else dict.fromkeys(OF_VALUES, _closed(limits))
        known[name] = _bounded({**bounds, **cells}, measured.description)
    of_values = dict.fromkeys(OF_VALUES, _closed(dict.fromkeys(LIMITS, _QUANTITY)))
    figure = _bounded({**of_values, **cells}, "A figure that the mission reports.")
    named = {**_closed(known), "patternProperties": {_FIGURE["pattern"]: figure}}
    listed = {"anyOf": [{"enum": list(known)}, _FIGURE]}
    return {"anyOf": [named, {"type": "array", "items": listed}]}


def _bounded(bounds: Schema, description: str) -> Schema:
    """Return the schema of one metric: no bound, one, or several."""
    one = _closed(bounds)
    forms = [{"type": "null"}, one, {"type": "array", "items": one}]
    return {"anyOf": forms, "description": description}


def _comparison() -> Schema:
    given: Schema = {
        "factor": _TEXT,
        "baseline": _LEVEL,
        "metrics": {
            "type": "array",
            "items": {"anyOf": [{"enum": list(installed_metrics())}, _FIGURE]},
            "minItems": 1,
        },
        "margin": {**_SHARE, "description": f"Difference that matters; {MARGIN} if absent."},
    }
    return _closed({key: given[key] for key in COMPARISON_KEYS}, "factor", "baseline")


def _one_or_more(schema: Schema) -> Schema:
    return {"anyOf": [schema, {"type": "array", "items": schema, "minItems": 1}]}


def _closed(properties: Mapping[str, Any], *required: str) -> Schema:
    schema: Schema = {
        "type": "object",
        "properties": dict(properties),
        "additionalProperties": False,
    }
    return {**schema, "required": list(required)} if required else schema
