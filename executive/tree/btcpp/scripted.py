"""Pre- and postconditions of BehaviorTree.CPP 4, which are scripts, around a node."""

from executive.tree.btcpp.attributes import SCRIPTS, CannotSayError, asked, assigned
from executive.tree.btcpp.elements import XmlElement
from executive.tree.btcpp.names import LEFT_OUT as ALWAYS_SKIPPED
from executive.tree.btcpp.wrapping import ALWAYS, LEFT_OUT, NEVER, Data, may_be_left_out, wrapped
from executive.tree.kind_keys import SKIP


def with_scripts(element: XmlElement, node: Data) -> Data:
    """Return a node with the scripts of its element around it, in the order in which they count.

    Asked are _failureIf, _successIf, _skipIf and _while, the first first; what a node writes at its
    end counts for the ends that these give, too, but not for one that is left out.

    Raises:
        CannotSayError: If there is no way to say it.
        ScriptError: If a script is none, or expressions cannot say it.
    """
    given = {name: element.get(name) for name in SCRIPTS if name in element.attributes}
    if element.tag == "AlwaysSuccess" and given == {"_skipIf": ALWAYS_SKIPPED}:
        return dict(LEFT_OUT)
    after = [given[key] for key in ("_onSuccess", "_post") if key in given]
    failing = [given[key] for key in ("_onFailure", "_post") if key in given]
    success = {"set": assigned(";".join(after))} if after else dict(ALWAYS)
    failure = {"set": assigned(";".join(failing))} if failing else None
    if "_onHalted" in given:
        node = wrapped(node, "on_halt", {"set": assigned(given["_onHalted"])})
    if after:
        if may_be_left_out(node):
            raise CannotSayError("_onSuccess and _post of a node that may be left out")
        node = {"sequence": [node, success]}
    if failure:
        node = wrapped(node, "on_failure", failure)
    if "_while" in given:
        node = {"while": asked(given["_while"]), "do": node, "else": SKIP}
    if "_skipIf" in given:
        node = wrapped(node, "if", asked(given["_skipIf"], negated=True))
    if "_successIf" in given:
        node = {"if": asked(given["_successIf"]), "then": success, "else": node}
    if "_failureIf" in given:
        failed = wrapped(dict(NEVER), "on_failure", failure) if failure else dict(NEVER)
        node = {"if": asked(given["_failureIf"]), "then": failed, "else": node}
    return node
