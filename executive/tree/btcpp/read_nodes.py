"""Elements of BehaviorTree.CPP 4 as nodes of a mission."""

from collections.abc import Callable, Mapping
from typing import Any

from executive.tree.btcpp.elements import XmlElement
from executive.tree.btcpp.names import BUILT_IN, COMPOSITES, OWN, TURNED
from executive.tree.btcpp.read_leaf import LeafImporter, literal, unwrapped
from executive.tree.btcpp.read_script import (
    ScriptError,
    read_assignments,
    read_condition,
    value_of,
)
from executive.tree.btcpp.wrapping import (
    ALWAYS,
    LEFT_OUT,
    NEVER,
    Data,
    may_be_left_out,
    wrapped,
)
from executive.tree.expressions.syntax import Key, Text, Truth, Unary
from executive.tree.problem import Problems

_CONDITIONS = ("_failureIf", "_successIf", "_skipIf", "_while")
_SCRIPTS = (*_CONDITIONS, "_onHalted", "_onFailure", "_onSuccess", "_post")
_KINDS = {tag: kind for kind, tag in (*COMPOSITES.items(), *TURNED.items())}
_ANY = -1  # children
# What has no counterpart, and what says it instead.
_UNKNOWN = {
    "AsyncSequence": "it ends the tick after each child; put a wait between the children",
    "AsyncFallback": "it ends the tick after each child; put a wait between the children",
    "KeepRunningUntilFailure": "it waits a tick after each round; write Repeat with num_cycles -1",
    "ManualSelector": "it asks at the terminal; write Ask",
    "UnsetBlackboard": "a key is never unset",
    "WasEntryUpdated": "keys do not tell when they were written",
    "SkipUnlessUpdated": "keys do not tell when they were written",
    "WaitValueUpdate": "keys do not tell when they were written",
    "Control": "only leaves and subtrees may be of one's own",
    "Decorator": "only leaves and subtrees may be of one's own",
}


class CannotSayError(ValueError):
    """The mission language has no words for an element; the message says why."""


class NodeImporter:
    """Turns elements into nodes; what cannot be said is noted, and the rest goes on."""

    def __init__(self, leaves: LeafImporter, trees: Mapping[str, str], problems: Problems) -> None:
        self._leaves = leaves
        self._trees = trees
        self._problems = problems
        self._readers: Mapping[str, tuple[int, Callable[[XmlElement], Data]]] = {
            "Parallel": (_ANY, self._parallel),
            "ParallelAll": (_ANY, self._parallel_all),
            "IfThenElse": (_ANY, self._if_then_else),
            "WhileDoElse": (_ANY, self._while_do_else),
            "TryCatch": (_ANY, self._try_catch),
            "ForceSuccess": (1, lambda one: wrapped(self._only(one), "optional", True)),
            "RetryUntilSuccessful": (1, self._retry),
            "Repeat": (1, self._repeat),
            "Timeout": (1, lambda one: wrapped(self._only(one), "timeout", _seconds(one, "msec"))),
            "Delay": (1, self._delay),
            "RunOnce": (1, self._once),
            "Precondition": (1, self._precondition),
            "AlwaysSuccess": (0, lambda _: dict(ALWAYS)),
            "AlwaysFailure": (0, lambda _: dict(NEVER)),
            "Script": (0, lambda one: {"set": _assigned(one.get("code"))}),
            "ScriptCondition": (0, lambda one: {"check": _asked(one.get("code"))}),
            "SetBlackboard": (0, lambda one: {"set": _stored(one)}),
            "Sleep": (0, lambda one: {"wait": _seconds(one, "msec")}),
            "SubTree": (0, self._call),
            **{f"Switch{count}": (count + 1, self._switch) for count in range(2, 7)},
            **{f"Loop{sort}": (1, self._queue) for sort in ("Int", "Bool", "Double", "String")},
            "ForEach": (1, lambda one: self._items(one, "for_each", "in", "items")),
            "Consume": (1, lambda one: self._items(one, "consume", "from", "queue")),
            "LoopUntil": (2, self._loop_until),
            "OnHalt": (2, self._on_halt),
            "Ask": (0, self._ask),
            "Holds": (0, lambda one: {"check": unwrapped(one.get("expression"))}),
        }

    def node(self, element: XmlElement) -> Data:
        """Return the node of an element; one that cannot be said is noted, and stands for nothing."""
        try:
            return self._with_scripts(element, self._named(element, self._plain(element)))
        except (CannotSayError, ScriptError) as error:
            self._problems.error(element.mark, f"{element.tag} cannot be said: {error}")
            return dict(NEVER)

    def _plain(self, element: XmlElement) -> Data:
        tag = element.tag
        if tag == "Sequence" and element.get("name") == "set":
            return {"set": _sets(element)}
        if tag in _UNKNOWN:
            raise CannotSayError(_UNKNOWN[tag])
        if tag in COMPOSITES.values():
            self._count(element, _ANY)
            return {_KINDS[tag]: [self.node(child) for child in element.children]}
        if tag in _KINDS:
            self._count(element, 1)
            return {_KINDS[tag]: self._only(element)}
        if tag in self._readers:
            count, read = self._readers[tag]
            self._count(element, count)
            return read(element)
        self._count(element, 0)
        return self._leaves.leaf(element, _given(element))

    def _count(self, element: XmlElement, wanted: int) -> None:
        found = len(element.children)
        if found != wanted and (wanted != _ANY or not found):
            told = "at least one child" if wanted == _ANY else f"{wanted} children"
            raise CannotSayError(f"it takes {told}, and has {found}")

    def _only(self, element: XmlElement) -> Data:
        return self.node(element.children[0])

    @staticmethod
    def _named(element: XmlElement, node: Data) -> Data:
        name = element.get("name")
        own = (element.tag, element.get("ID"), "")
        if name in own or (element.tag == "Sequence" and name == "set"):
            return node
        if "name" in node or any(key in node for key in ("do", "optional", "once")):
            return {"sequence": [node], "name": name}
        return {**node, "name": name}

    # --- pre- and postconditions, in the order in which BehaviorTree.CPP asks them

    def _with_scripts(self, element: XmlElement, node: Data) -> Data:
        given = {name: element.get(name) for name in _SCRIPTS if name in element.attributes}
        if element.tag == "AlwaysSuccess" and given == {"_skipIf": "true"}:
            return dict(LEFT_OUT)
        after = [given[key] for key in ("_onSuccess", "_post") if key in given]
        failing = [given[key] for key in ("_onFailure", "_post") if key in given]
        success = {"set": _assigned(";".join(after))} if after else dict(ALWAYS)
        failure = {"set": _assigned(";".join(failing))} if failing else None
        if "_onHalted" in given:
            node = wrapped(node, "on_halt", {"set": _assigned(given["_onHalted"])})
        if after:
            if may_be_left_out(node):
                raise CannotSayError("_onSuccess and _post of a node that may be skipped")
            node = {"sequence": [node, success]}
        if failure:
            node = wrapped(node, "on_failure", failure)
        if "_while" in given:
            node = {"while": _asked(given["_while"]), "do": node, "else": dict(LEFT_OUT)}
        if "_skipIf" in given:
            node = wrapped(node, "if", _asked(given["_skipIf"], negated=True))
        if "_successIf" in given:
            node = {"if": _asked(given["_successIf"]), "then": success, "else": node}
        if "_failureIf" in given:
            failed = wrapped(dict(NEVER), "on_failure", failure) if failure else dict(NEVER)
            node = {"if": _asked(given["_failureIf"]), "then": failed, "else": node}
        return node

    # --- controls

    def _parallel(self, element: XmlElement) -> Data:
        count = len(element.children)
        succeed = _threshold(element, "success_count", "-1", count)
        fail = _threshold(element, "failure_count", "1", count)
        node: Data = {"parallel": [self.node(child) for child in element.children]}
        if succeed != count:
            node["succeed"] = succeed
        fail = min(fail, count - succeed + 1)  # with more failures too few are left to succeed
        return {**node, "fail": fail} if fail != count - succeed + 1 else node

    def _parallel_all(self, element: XmlElement) -> Data:
        fail = _threshold(element, "max_failures", "1", len(element.children))
        node = {"parallel": [self.node(child) for child in element.children], "wait_for_all": True}
        return node if fail == 1 else {**node, "fail": fail}

    def _if_then_else(self, element: XmlElement) -> Data:
        condition, then, *otherwise = self._branches(element)
        if not otherwise:
            return {"if": condition, "then": then, "else": dict(NEVER)}
        if otherwise[0] == LEFT_OUT:
            return wrapped(then, "if", condition)
        return {"if": condition, "then": then, "else": otherwise[0]}

    def _while_do_else(self, element: XmlElement) -> Data:
        condition, body, *otherwise = self._branches(element)
        if not otherwise:
            return wrapped(body, "while", condition)
        return {"while": condition, "do": body, "else": otherwise[0]}

    def _branches(self, element: XmlElement) -> list[Any]:
        if len(element.children) not in (2, 3):
            raise CannotSayError(f"it takes 2 or 3 children, and has {len(element.children)}")
        return [self.condition(element.children[0]), *map(self.node, element.children[1:])]

    def _try_catch(self, element: XmlElement) -> Data:
        if len(element.children) < 2:
            raise CannotSayError("it takes at least 2 children")
        if _truth(element, "catch_on_halt"):
            raise CannotSayError("catch_on_halt; write the script of _onHalted")
        *tried, caught = [self.node(child) for child in element.children]
        body = tried[0] if len(tried) == 1 else {"sequence": tried}
        return wrapped(body, "on_failure", caught)

    def _switch(self, element: XmlElement) -> Data:
        *several, otherwise = [self.node(child) for child in element.children]
        cases: dict[str, Data] = {}
        for number, node in enumerate(several, 1):
            cases.setdefault(element.get(f"case_{number}"), node)
        if otherwise.keys() == {"switch", "cases"} | (otherwise.keys() & {"else"}):
            same = otherwise["switch"] == element.get("variable")
            if same and not cases.keys() & otherwise["cases"].keys():  # one with too many cases
                return {**otherwise, "cases": {**cases, **otherwise["cases"]}}
        node: Data = {"switch": element.get("variable"), "cases": cases}
        return node if otherwise == NEVER else {**node, "else": otherwise}

    # --- decorators

    def _retry(self, element: XmlElement) -> Data:
        attempts, child = _number(element, "num_attempts"), self._only(element)
        if attempts < 1:
            raise CannotSayError("attempts without end; a retry has a bound")
        pause = child.get("on_failure", {})
        if pause.keys() == {"wait"} and next(k for k in child if k in ("on_failure", "optional")):
            kept = {key: value for key, value in child.items() if key != "on_failure"}
            return wrapped(kept, "retry", {"attempts": attempts, "pause": pause["wait"]})
        return wrapped(child, "retry", attempts)

    def _repeat(self, element: XmlElement) -> Data:
        cycles = _number(element, "num_cycles")
        if cycles == 0 or cycles < -1:
            raise CannotSayError(f"num_cycles is {cycles}; a loop has at least one round")
        head: Any = "forever" if cycles == -1 else {"max": cycles}
        return {"loop": head, "do": self._only(element)}

    def _loop_until(self, element: XmlElement) -> Data:
        head: Data = {"until": self.condition(element.children[0])}
        if "max" in element.attributes:
            head["max"] = _number(element, "max")
        return {"loop": head, "do": self.node(element.children[1])}

    def _delay(self, element: XmlElement) -> Data:
        return {"sequence": [{"wait": _seconds(element, "delay_msec")}, self._only(element)]}

    def _once(self, element: XmlElement) -> Data:
        if not _truth(element, "then_skip", "true"):
            raise CannotSayError("then_skip=false; what has run once is left out afterwards")
        return wrapped(self._only(element), "once", True)

    def _on_halt(self, element: XmlElement) -> Data:
        body, cleanup = map(self.node, element.children)
        return wrapped(body, "on_halt", cleanup)

    def _precondition(self, element: XmlElement) -> Data:
        ends = {"SUCCESS": ALWAYS, "FAILURE": NEVER, "SKIPPED": LEFT_OUT}
        end = element.get("else", "FAILURE")
        if end not in ends:
            raise CannotSayError(f"else={end}; a condition that does not hold keeps nothing running")
        condition, then = _asked(element.get("if")), self._only(element)
        if end == "SKIPPED":
            return wrapped(then, "if", condition)
        return {"if": condition, "then": then, "else": dict(ends[end])}

    def _queue(self, element: XmlElement) -> Data:
        if element.get("if_empty", "SUCCESS") != "SUCCESS":
            raise CannotSayError("if_empty; ask for the list's length before the loop")
        queue, item = element.get("queue"), _pointer(element, "value")
        if "{" in queue:
            return {"consume": {"item": item, "from": queue}, "do": self._only(element)}
        texts = [text for text in queue.split(";") if text]
        items = texts if element.tag == "LoopString" else [literal(text) for text in texts]
        return {"for_each": {"item": item, "in": items}, "do": self._only(element)}

    def _items(self, element: XmlElement, kind: str, word: str, attribute: str) -> Data:
        source = unwrapped(element.get(attribute))
        given = source if "{" in source else literal(source)
        return {kind: {"item": _pointer(element, "item"), word: given}, "do": self._only(element)}

    # --- leaves of the language

    def _ask(self, element: XmlElement) -> Data:
        node: Data = {"ask": element.get("question")}
        if element.get("choices"):
            node["choices"] = element.get("choices").split(";")
        if element.get("default"):
            text = element.get("default")
            node["default"] = text if "choices" in node else literal(text)
        return {**node, "out": {"answer": element.get("answer")}} if element.get("answer") else node

    def _call(self, element: XmlElement) -> Data:
        name = element.get("ID")
        if name not in self._trees:
            raise CannotSayError(f"there is no tree '{name}' in this file")
        given = {key: text for key, text in _given(element).items() if key != "_autoremap"}
        node: Data = {"call": self._trees[name], "ports": given, "mark": element.mark}
        if _truth(element, "_autoremap"):
            node["is_automatic"] = True
        return node

    # --- conditions

    def condition(self, element: XmlElement) -> Any:
        """Return a condition.

        Raises:
            CannotSayError: If it is made of more than conditions.
        """
        told = f"{element.tag} stands for a condition, which answers at once and has no modifiers"
        if any(name in element.attributes for name in _SCRIPTS):
            raise CannotSayError(told)
        if element.tag in ("Sequence", "Fallback", "Inverter"):
            parts = [self.condition(child) for child in element.children]
            how = {"Sequence": "all", "Fallback": "any", "Inverter": "not"}[element.tag]
            return {how: parts[0] if how == "not" else parts}
        node = self._plain(element)
        if "check" not in node:
            raise CannotSayError(told)
        is_plain = node.keys() == {"check"} and isinstance(node["check"], bool | str)
        return node["check"] if is_plain else node


def _given(element: XmlElement) -> dict[str, str]:
    taken = ("ID", "name", *_SCRIPTS)
    return {key: text for key, text in element.attributes.items() if key not in taken}


def is_builtin(tag: str) -> bool:
    """Whether a tag is the library's own, or one of the mission language."""
    return tag in BUILT_IN or tag in OWN


def _asked(script: str, *, negated: bool = False) -> Any:
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


def _assigned(script: str) -> Data:
    return {one.key: value_of(one.value) for one in read_assignments(script)}


def _sets(element: XmlElement) -> Data:
    values: Data = {}
    for child in element.children:
        values |= _assigned(child.get("code")) if child.tag == "Script" else _stored(child)
    return values


def _stored(element: XmlElement) -> Data:
    text, key = element.get("value"), element.get("output_key").strip("{}")
    value = unwrapped(text) if "{" in text else literal(text)
    return {key: value_of(Text(value)) if isinstance(value, str) and "{" not in value else value}


def _truth(element: XmlElement, name: str, otherwise: str = "false") -> bool:
    text = element.get(name, otherwise).lower()
    if text in ("true", "1", "false", "0"):
        return text in ("true", "1")
    raise CannotSayError(f"{name} is '{text}', not true or false")


def _number(element: XmlElement, name: str, otherwise: str = "") -> int:
    text = element.get(name, otherwise)
    try:
        return int(text)
    except ValueError:
        raise CannotSayError(f"{name} is '{text}', and must be a whole number here") from None


def _seconds(element: XmlElement, name: str) -> float:
    milliseconds = _number(element, name)
    if milliseconds <= 0:
        raise CannotSayError(f"{name} is {milliseconds}; a duration is more than 0")
    return milliseconds / 1000


def _threshold(element: XmlElement, name: str, otherwise: str, count: int) -> int:
    number = _number(element, name, otherwise)
    number = count + number + 1 if number < 0 else number
    if 1 <= number <= count:
        return number
    raise CannotSayError(f"{name} is {element.get(name, otherwise)} of {count} children")


def _pointer(element: XmlElement, name: str) -> str:
    text = element.get(name)
    if text.startswith("{") and text.endswith("}"):
        return text[1:-1]
    raise CannotSayError(f"{name} is '{text}', not a key such as '{{item}}'")
