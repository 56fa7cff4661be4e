"""The JSON schema of mission files, for completion in editors; built from what is installed.

It says what an editor can know: keys, names, settings and their bounds. What needs the whole
mission (calls, keys that are read before they are written, what a leaf needs) is told by `executive
check`.
"""

from collections.abc import Iterator
from typing import Any, get_args

from executive.config import Settings
from executive.errors import ConfigError
from executive.faults.description import KINDS
from executive.leaf.action import Action, Leaf
from executive.registry import is_plural
from executive.tree.catalogue import Catalogue, InstalledCatalogue
from executive.tree.instances import SINGLE, USE
from executive.tree.loop_settings import LoopSettings
from executive.tree.node_schema import (
    CONDITION,
    EXPRESSION,
    PLUGIN_NAMES,
    WORD,
    Schema,
    any_of,
    as_tree,
    node_kinds,
    wires,
)
from executive.tree.region_reader import RegionShape
from executive.tree.selection import ON_ERROR, ON_ERROR_WORDS
from executive.tree.sources import API
from executive.watch.rules import (
    EFFORT,
    ESTIMATE,
    GEOFENCE,
    JOINT_LIMITS,
    PRESSURE,
    TRACKING,
    Do,
    EstimateRule,
    GeofenceRule,
    Rule,
    TrackingRule,
)


def mission_schema(catalogue: Catalogue | None = None) -> Schema:
    """Return the schema (draft 2020-12); what cannot be imported takes any settings."""
    return _Builder(catalogue or InstalledCatalogue()).mission()


class _Builder:
    def __init__(self, catalogue: Catalogue) -> None:
        self._catalogue = catalogue
        self._defs: Schema = {}
        self._leaves = dict(self._loaded())

    def _loaded(self) -> Iterator[tuple[str, type[Leaf[Any]]]]:
        for name in self._catalogue.behaviour_names():
            try:
                yield name, self._catalogue.behaviour(name)
            except ConfigError:  # a broken one must not keep the editor from knowing the others
                continue

    def mission(self) -> Schema:
        """Return the whole schema."""
        kinds = [*node_kinds(), *self._leaf_kinds()]
        self._defs |= {
            "node": any_of(kinds),
            "condition": self._condition(),
            "tree": any_of(map(as_tree, kinds)),
        }
        plugins = {
            capability: self._capability(capability)
            for capability in self._catalogue.capabilities()
        }
        properties: Schema = {
            "api": {"const": API, "description": "Version of the mission language."},
            "mission": WORD,
            "description": {"type": "string"},
            "extends": {
                "type": "string",
                "description": "A mission file whose settings and trees are the base.",
            },
            "loop": self._settings("loop", LoopSettings),
            "plugins": {"type": "object", "properties": plugins, "additionalProperties": False},
            "regions": {
                "type": "object",
                "description": "Named parts of the ground: a polygon, a box or a corridor.",
                "additionalProperties": self._settings("region", RegionShape),
            },
            "watch": self._watch(),
            "faults": {"type": "array", "items": {"anyOf": self._faults()}},
            "trees": {"type": "object", "additionalProperties": {"$ref": "#/$defs/tree"}},
        }
        return {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": "A mission",
            "type": "object",
            "properties": properties,
            "required": ["api"],
            "additionalProperties": False,
            "$defs": self._defs,
        }

    # --- plugins

    def _capability(self, capability: str) -> Schema:
        names = self._catalogue.plugin_names(capability)
        partly = {
            "type": "object",
            "not": {"required": ["plugin"]},
        }  # settings laid over the plugin of the base
        one: Schema = {
            "anyOf": [
                {"enum": list(names)},
                *(self._plugin(capability, name) for name in names),
                partly,
            ]
        }
        if capability not in SINGLE and names:
            plugin = [self._plugin(capability, name) for name in names]
            named = {
                "type": "object",
                "description": "Several plugins, each under a name that `use:` chooses.",
                "not": {"required": ["plugin"]},
                "additionalProperties": {"anyOf": plugin},
            }
            return {"anyOf": [*one["anyOf"], named]}
        if not is_plural(capability):
            return one
        return {"anyOf": [*one["anyOf"], {"type": "array", "items": one}]}

    def _plugin(self, capability: str, name: str) -> Schema:
        try:
            settings = self._settings(
                f"{capability}.{name}", self._catalogue.declared(capability, name).settings
            )
        except ConfigError as error:
            settings = {"type": "object", "description": str(error), "properties": {}}
        # A layer above may bring what is required, so that no key is required of one file.
        return {
            **{key: value for key, value in settings.items() if key != "required"},
            "properties": {
                "plugin": {"const": name},
                ON_ERROR: {"enum": list(ON_ERROR_WORDS)},
                USE: PLUGIN_NAMES,
                **settings.get("properties", {}),
            },
            "required": ["plugin"],
        }

    def _settings(self, prefix: str, settings: type[Settings]) -> Schema:
        schema = settings.model_json_schema(ref_template=f"#/$defs/{prefix}.{{model}}")
        for name, definition in schema.pop("$defs", {}).items():
            self._defs[f"{prefix}.{name}"] = definition
        return schema

    # --- watch and faults

    def _watch(self) -> Schema:
        """Return the rules by condition; which sensors there are is the machine's file's."""
        names: dict[str, type[Rule]] = {
            ESTIMATE: EstimateRule,
            GEOFENCE: GeofenceRule,
            TRACKING: TrackingRule,
        }
        known = {name: self._rule(rule) for name, rule in names.items()}
        known |= {name: self._rule(Rule) for name in (JOINT_LIMITS, EFFORT, PRESSURE)}
        return {
            "type": "object",
            "properties": known,
            "additionalProperties": self._rule(Rule),
            "description": "What is watched while the mission runs, and what happens then.",
        }

    def _rule(self, rule: type[Rule]) -> Schema:
        words = {"enum": list(get_args(Do))}
        return {"anyOf": [words, self._settings(f"watch.{rule.__name__}", rule)]}

    def _faults(self) -> list[Schema]:
        return [self._settings(f"faults.{kind}", settings) for kind, settings in KINDS.items()]

    # --- nodes

    def _leaf_kinds(self) -> Iterator[Schema]:
        for name, leaf in self._leaves.items():
            yield self._leaf("run" if issubclass(leaf, Action) else "check", name, leaf)

    def _leaf(self, key: str, name: str, leaf: type[Leaf[Any]]) -> Schema:
        definition = f"behaviour.{name}"
        if definition not in self._defs:
            self._defs[definition] = _computable(self._settings(definition, leaf.Settings))
        is_needed = "required" in self._defs[definition]
        properties = {
            key: {"const": name, "description": (leaf.__doc__ or "").strip().partition("\n")[0]},
            "with": {"$ref": f"#/$defs/{definition}"},
            "in": wires({port: spec.doc for port, spec in leaf.inputs.items()}, EXPRESSION),
            "out": wires({port: spec.doc for port, spec in leaf.outputs.items()}),
            USE: PLUGIN_NAMES,
        }
        return {"properties": properties, "required": [key, *(["with"] if is_needed else [])]}

    def _condition(self) -> Schema:
        checks = {name: leaf for name, leaf in self._leaves.items() if not issubclass(leaf, Action)}
        parts = {"type": "array", "items": CONDITION, "minItems": 1}
        forms: list[Schema] = [
            {"properties": {"not": CONDITION}, "required": ["not"]},
            {"properties": {"all": parts}, "required": ["all"]},
            {"properties": {"any": parts}, "required": ["any"]},
            *(self._leaf("check", name, leaf) for name, leaf in checks.items()),
        ]
        closed = [{"type": "object", **form, "additionalProperties": False} for form in forms]
        return {"anyOf": [EXPRESSION, {"type": "boolean"}, {"enum": sorted(checks)}, *closed]}


def _computable(settings: Schema) -> Schema:
    """Return the schema of a leaf's settings, each of which may be an expression."""
    properties = {
        name: {"anyOf": [one, EXPRESSION], **_described(one)}
        for name, one in settings.get("properties", {}).items()
    }
    return {**settings, "properties": properties} if properties else settings


def _described(one: Schema) -> Schema:
    return {key: one[key] for key in ("description", "default") if key in one}
