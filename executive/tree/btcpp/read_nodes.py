"""Elements of BehaviorTree.CPP 4 as nodes of a mission."""

from collections.abc import Callable, Mapping
from typing import Any

from executive.tree.btcpp.attributes import (
    SCRIPTS,
    CannotSayError,
    asked,
    assigned,
    given_ports,
    number,
    pointer,
    seconds,
    several_sets,
    stored,
    threshold,
    truth,
)
from executive.tree.btcpp.elements import XmlElement
from executive.tree.btcpp.names import COMPOSITES, TURNED, USES, uses_of_attribute
from executive.tree.btcpp.read_leaf import LeafImporter, literal, unwrapped
from executive.tree.btcpp.read_script import ScriptError
from executive.tree.btcpp.scripted import with_scripts
from executive.tree.btcpp.wrapping import ALWAYS, LEFT_OUT, NEVER, Data, is_outermost, wrapped
from executive.tree.kind_keys import SKIP
from executive.tree.problem import Problems

_KINDS = {tag: kind for kind, tag in (*COMPOSITES.items(), *TURNED.items())}
_MODIFIERS = (
    *("ForceSuccess", "RetryUntilSuccessful", "Timeout", "Delay", "RunOnce", "Precondition"),
    *("OnHalt", "TryCatch", "IfThenElse", "WhileDoElse"),
)
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
            "Timeout": (1, lambda one: wrapped(self._only(one), "timeout", seconds(one, "msec"))),
            "Delay": (1, self._delay),
            "RunOnce": (1, self._once),
            "Precondition": (1, self._precondition),
            "AlwaysSuccess": (0, lambda _: dict(ALWAYS)),
            "AlwaysFailure": (0, lambda _: dict(NEVER)),
            "Script": (0, lambda one: {"set": assigned(one.get("code"))}),
            "ScriptCondition": (0, lambda one: {"check": asked(one.get("code"))}),
            "SetBlackboard": (0, lambda one: {"set": stored(one)}),
            "Sleep": (0, lambda one: {"wait": seconds(one, "msec")}),
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
        """Return the node of an element; what cannot be said is noted."""
        try:
            return with_scripts(element, self._named(element, self._plain(element)))
        except (CannotSayError, ScriptError) as error:
            self._problems.error(element.mark, f"{element.tag} cannot be said: {error}")
            return dict(NEVER)

    def _plain(self, element: XmlElement) -> Data:
        tag = element.tag
        if tag == "Sequence" and element.get("name") == "set":
            return {"set": several_sets(element)}
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
        return self._leaves.leaf(element, given_ports(element))

    def _count(self, element: XmlElement, wanted: int) -> None:
        found = len(element.children)
        if found != wanted and (wanted != _ANY or not found):
            number_told = "1 child" if wanted == 1 else f"{wanted} children"
            told = "at least one child" if wanted == _ANY else number_told
            raise CannotSayError(f"it takes {told}, and has {found}")

    def _only(self, element: XmlElement) -> Data:
        return self.node(element.children[0])

    @staticmethod
    def _named(element: XmlElement, node: Data) -> Data:
        name = element.get("name")
        own = (element.tag, element.get("ID"), "")
        if name in own or (element.tag == "Sequence" and name == "set"):
            return node
        is_modifier = element.tag in _MODIFIERS and not {"then", "else"} & node.keys()
        if "name" in node or is_modifier:  # the name would become that of the node within
            return {"sequence": [node], "name": name}
        return {**node, "name": name}

    # --- controls

    def _parallel(self, element: XmlElement) -> Data:
        count = len(element.children)
        succeed = threshold(element, "success_count", "-1", count)
        fail = threshold(element, "failure_count", "1", count)
        node: Data = {"parallel": [self.node(child) for child in element.children]}
        if succeed != count:
            node["succeed"] = succeed
        fail = min(fail, count - succeed + 1)  # with more failures too few are left to succeed
        return {**node, "fail": fail} if fail != count - succeed + 1 else node

    def _parallel_all(self, element: XmlElement) -> Data:
        fail = threshold(element, "max_failures", "1", len(element.children))
        node: Data = {
            "parallel": [self.node(child) for child in element.children],
            "wait_for_all": True,
        }
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
        last = SKIP if otherwise[0] == LEFT_OUT else otherwise[0]
        return {"while": condition, "do": body, "else": last}

    def _branches(self, element: XmlElement) -> list[Any]:
        if len(element.children) not in (2, 3):
            raise CannotSayError(f"it takes 2 or 3 children, and has {len(element.children)}")
        return [self.condition(element.children[0]), *map(self.node, element.children[1:])]

    def _try_catch(self, element: XmlElement) -> Data:
        if len(element.children) < 2:
            raise CannotSayError("it takes at least 2 children")
        if truth(element, "catch_on_halt"):
            raise CannotSayError("catch_on_halt; write the script of _onHalted")
        *tried, caught = [self.node(child) for child in element.children]
        body = tried[0] if len(tried) == 1 else {"sequence": tried}
        return wrapped(body, "on_failure", caught)

    def _switch(self, element: XmlElement) -> Data:
        *several, otherwise = [self.node(child) for child in element.children]
        cases: dict[str, Data] = {}
        for place, case in enumerate(several, 1):
            cases.setdefault(element.get(f"case_{place}"), case)
        if otherwise.keys() == {"switch", "cases"} | (otherwise.keys() & {"else"}):
            same = otherwise["switch"] == element.get("variable")
            if same and not cases.keys() & otherwise["cases"].keys():  # one with too many cases
                return {**otherwise, "cases": {**cases, **otherwise["cases"]}}
        node: Data = {"switch": element.get("variable"), "cases": cases}
        return node if otherwise == NEVER else {**node, "else": otherwise}

    # --- decorators

    def _retry(self, element: XmlElement) -> Data:
        attempts, child = number(element, "num_attempts"), self._only(element)
        if attempts < 1:
            raise CannotSayError("attempts without end; a retry has a bound")
        if child.get("on_failure", {}).keys() == {"wait"} and is_outermost(child, "on_failure"):
            pause = child.pop("on_failure")["wait"]
            body = child["do"] if child.keys() == {"do"} else child
            return wrapped(body, "retry", {"attempts": attempts, "pause": pause})
        return wrapped(child, "retry", attempts)

    def _repeat(self, element: XmlElement) -> Data:
        cycles = number(element, "num_cycles")
        if cycles == 0 or cycles < -1:
            raise CannotSayError(f"num_cycles is {cycles}; a loop has at least one round")
        head: Any = "forever" if cycles == -1 else {"max": cycles}
        return {"loop": head, "do": self._only(element)}

    def _loop_until(self, element: XmlElement) -> Data:
        head: Data = {"until": self.condition(element.children[0])}
        if "max" in element.attributes:
            head["max"] = number(element, "max")
        return {"loop": head, "do": self.node(element.children[1])}

    def _delay(self, element: XmlElement) -> Data:
        return {"sequence": [{"wait": seconds(element, "delay_msec")}, self._only(element)]}

    def _once(self, element: XmlElement) -> Data:
        if not truth(element, "then_skip", "true"):
            raise CannotSayError("then_skip=false; what has run once is left out afterwards")
        return wrapped(self._only(element), "once", True)

    def _on_halt(self, element: XmlElement) -> Data:
        body, cleanup = map(self.node, element.children)
        return wrapped(body, "on_halt", cleanup)

    def _precondition(self, element: XmlElement) -> Data:
        ends = {"SUCCESS": ALWAYS, "FAILURE": NEVER, "SKIPPED": LEFT_OUT}
        end = element.get("else", "FAILURE")
        if end not in ends:
            raise CannotSayError(f"else={end}; it cannot go on running")
        condition, then = asked(element.get("if")), self._only(element)
        if end == "SKIPPED":
            return wrapped(then, "if", condition)
        return {"if": condition, "then": then, "else": dict(ends[end])}

    def _queue(self, element: XmlElement) -> Data:
        if element.get("if_empty", "SUCCESS") != "SUCCESS":
            raise CannotSayError("if_empty; ask for the list's length before the loop")
        queue, item = element.get("queue"), pointer(element, "value")
        if "{" in queue:
            return {"consume": {"item": item, "from": queue}, "do": self._only(element)}
        texts = [text for text in queue.split(";") if text]
        items = texts if element.tag == "LoopString" else [literal(text) for text in texts]
        return {"for_each": {"item": item, "in": items}, "do": self._only(element)}

    def _items(self, element: XmlElement, kind: str, word: str, attribute: str) -> Data:
        source = unwrapped(element.get(attribute))
        given = source if "{" in source else literal(source)
        return {kind: {"item": pointer(element, "item"), word: given}, "do": self._only(element)}

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
        given = {key: text for key, text in given_ports(element).items() if key != "_autoremap"}
        node: Data = {"call": self._trees[name], "ports": given, "mark": element.mark}
        if USES in given:
            node[USES] = uses_of_attribute(given.pop(USES))
        if truth(element, "_autoremap"):
            node["is_automatic"] = True
        return node

    # --- conditions

    def condition(self, element: XmlElement) -> Any:
        """Return a condition.

        Raises:
            CannotSayError: If it is made of more than conditions.
        """
        told = f"{element.tag} stands for a condition, which answers at once and has no modifiers"
        if any(name in element.attributes for name in SCRIPTS):
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
