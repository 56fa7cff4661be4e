"""What a condition with `has` tells to be there."""

from executive.tree.expressions.syntax import Binary, Expression, Field, Function, Index, Unary


def asked_for(one: Expression, is_true: bool) -> frozenset[str]:
    """Return what is there if a condition is true, or if it is false: `has({x})` for one."""
    if isinstance(one, Function) and one.name == "has" and is_true:
        found, part = set(), one.arguments[0] if one.arguments else None
        while part is not None:
            found.add(str(part))
            part = part.of if isinstance(part, Field | Index) else None
        return frozenset(found)
    if isinstance(one, Unary) and one.op == "not":
        return asked_for(one.of, not is_true)
    if isinstance(one, Binary) and one.op == ("and" if is_true else "or"):
        return asked_for(one.left, is_true) | asked_for(one.right, is_true)
    return frozenset()
