"""Values of attributes: scripts, numbers, keys."""

from typing import Any

from executive.tree.btcpp.elements import XmlElement
from executive.tree.btcpp.read_leaf import literal, unwrapped
from executive.tree.btcpp.read_script import read_assignments, read_condition, value_of
from executive.tree.btcpp.wrapping import Data
from executive.tree.expressions.syntax import Key, Text, Truth, Unary

SCRIPTS = (
    *("_failureIf", "_successIf", "_skipIf", "_while"),
    *("_onHalted", "_onFailure", "_onSuccess", "_post"),
)


class CannotSayError(ValueError):
    """The mission language has no words for an element; the message says why."""


def given_ports(element: XmlElement) -> dict[str, str]:
    """Return the attributes that are ports."""
    taken = ("ID", "name", *SCRIPTS)
    return {key: text for key, text in element.attributes.items() if key not in taken}


def asked(script: str, *, negated: bool = False) -> Any:
    """Return a script as a condition."""
    expression = read_condition(script)
    if isinstance(expression, Truth):
        return expression.value is not negated
    if isinstance(expression, Unary) and expression.op == "not" and negated:
        expression, negated = expression.of, False
    if negated and isinstance(expression, Key):
        return {"not": str(expression)}
    return str(Unary("not", expression) if negated else _plain_key(expression))


def _plain_key(expression: Any) -> Any:
    """Return `{key}` for `{key} == true`."""
    is_truth = getattr(expression, "op", "") == "==" and expression.right == Truth(True)
    return expression.left if is_truth else expression


def assigned(script: str) -> Data:
    """Return what a script writes, by key."""
    return {one.key: value_of(one.value) for one in read_assignments(script)}


def several_sets(element: XmlElement) -> Data:
    """Return what the children of an element write, by key."""
    values: Data = {}
    for child in element.children:
        values |= assigned(child.get("code")) if child.tag == "Script" else stored(child)
    return values


def stored(element: XmlElement) -> Data:
    """Return what a SetBlackboard writes."""
    text, key = element.get("value"), element.get("output_key").strip("{}")
    value = unwrapped(text) if "{" in text else literal(text)
    return {key: value_of(Text(value)) if isinstance(value, str) and "{" not in value else value}


def truth(element: XmlElement, name: str, otherwise: str = "false") -> bool:
    """Return a truth value."""
    text = element.get(name, otherwise).lower()
    if text in ("true", "1", "false", "0"):
        return text in ("true", "1")
    raise CannotSayError(f"{name} is '{text}', not true or false")


def number(element: XmlElement, name: str, otherwise: str = "") -> int:
    """Return a whole number."""
    text = element.get(name, otherwise)
    try:
        found = int(text)
    except ValueError:
        raise CannotSayError(f"{name} is '{text}', and must be a whole number here") from None
    if not -(2**63) <= found < 2**63:  # what BehaviorTree.CPP can hold
        raise CannotSayError(f"{name} has {len(text)} digits; that is too large a number")
    return found


def seconds(element: XmlElement, name: str) -> float:
    """Return a duration [s]."""
    milliseconds = number(element, name)
    if milliseconds <= 0:
        raise CannotSayError(f"{name} is {milliseconds}; a duration is more than 0")
    return milliseconds / 1000


def threshold(element: XmlElement, name: str, otherwise: str, count: int) -> int:
    """Return a number of children; a negative one counts from all."""
    given = number(element, name, otherwise)
    given = count + given + 1 if given < 0 else given
    if 1 <= given <= count:
        return given
    raise CannotSayError(f"{name} is {element.get(name, otherwise)} of {count} children")


def pointer(element: XmlElement, name: str) -> str:
    """Return the key that an attribute points at."""
    text = element.get(name)
    if text.startswith("{") and text.endswith("}"):
        return text[1:-1]
    raise CannotSayError(f"{name} is '{text}', not a key such as '{{item}}'")
