"""Types of settings, and whether the value of a key or an expression suits them."""

import json
import typing
from typing import Any

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from executive.config import Settings
from executive.tree.expressions.functions import shown
from executive.tree.expressions.kinds import bare, dimension_of, item_of, members, sort_of


def takes_text(field: FieldInfo) -> bool:
    """Whether a setting is a text, in which keys in braces are filled in."""
    return any(sort_of(kind) in ("text", "choice") for kind in members(field_type(field)))


def field_type(field: FieldInfo) -> Any:
    """Return a setting's type, with its dimension if it is a quantity."""
    if not field.metadata:
        return field.annotation
    return typing.Annotated[field.annotation, *field.metadata]


def suits_setting(have: Any, wanted: Any) -> bool:
    """Whether a value of a type can be a setting; settings are as exact as in the file."""
    return any(_suits(one, other) for one in members(have) for other in members(wanted))


def setting_name(wanted: Any) -> str:
    """Return a setting's type for a sentence."""
    kinds = [f"a {bare(one).__name__}" if sort_of(one) == "object" else shown(one)
             for one in members(wanted)]  # fmt: skip
    whole = {"a number": "a whole number"} if bare(wanted) is int else {}
    return " or ".join(dict.fromkeys(whole.get(kind, kind) for kind in kinds))


def _suits(have: Any, wanted: Any) -> bool:
    sorts = sort_of(have), sort_of(wanted)
    if "unknown" in sorts:
        return True
    if sorts == ("number", "number"):
        if bare(wanted) is int and bare(have) is not int:
            return False
        one, other = dimension_of(have), dimension_of(wanted)
        return bare(wanted) is int or one is None or other is None or one.suits(other)
    if sorts in (("text", "choice"), ("choice", "text"), ("array", "list")):
        return True
    if sorts == ("list", "list"):
        return _suits_any(item_of(have), item_of(wanted))
    return sorts[0] == sorts[1] and sorts[0] != "object"


def _suits_any(have: Any, wanted: Any) -> bool:
    return suits_setting(have, wanted)


def refusal(settings: type[Settings], name: str, value: Any) -> str:
    """Return why a settings class refuses a value of one setting; empty if it takes it."""
    try:
        settings.model_validate_json(json.dumps({name: value}), strict=True)
    except ValidationError as error:
        for finding in error.errors(include_url=False):
            if finding["loc"][:1] == (name,):
                return str(finding["msg"]).removeprefix("Value error, ")
    return ""
