"""What can be done wrong to one node of a syntax tree: a generator for each kind of mistake.

Two kinds are not generated, because no input could tell them from the original:

- `<` in place of `<=` (and the like) between measured quantities. They differ at one value of a
  real number, which no measurement takes. The inverted comparison is generated. Not of this kind
  are comparisons with zero, which a difference, a speed or a length can be; times, which are
  multiples of a tick; and shares, which are quotients of counts.
- `strict=False` in `zip`. It is an assertion that two lengths are equal, and like other assertions
  it does nothing as long as the rest is right.
"""

import ast
import copy
from collections.abc import Callable, Iterator

Wrong = Iterator[tuple[str, ast.AST]]

_COMPARED: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
_CALCULATED: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
}


# Quantities by the ends of their names, as the naming rules of this project ask for.
_UNITS = {"m", "mm", "m2", "m3", "rad", "deg", "n", "nm", "kg", "kgm2", "pa", "mps", "mps2", "rps"}
_DISCRETE = {"s", "ms", "us", "share", "ratio", "overlap", "percent"}
_REAL_CALLS = {"norm", "hypot", "sqrt", "arccos", "arctan2", "exp"}


def _comparison(node: ast.AST) -> Wrong:
    if isinstance(node, ast.Compare):
        sides = [node.left, *node.comparators]
        for i, operator in enumerate(node.ops):
            others = _COMPARED[type(operator)]
            for other in others[1:] if _is_measured(sides[i], sides[i + 1]) else others:
                wrong = copy.deepcopy(node)
                wrong.ops[i] = other()
                yield "comparison", wrong


def _is_measured(left: ast.expr, right: ast.expr) -> bool:
    """Return whether two sides are real numbers, and neither is zero, a time or a share."""
    if any(_is_discrete(side) for side in (left, right)):
        return False
    return _is_real(left) or _is_real(right)


def _is_discrete(node: ast.expr) -> bool:
    """Return whether an expression is zero, or holds a time or a share."""
    if isinstance(node, ast.Constant):
        return node.value == 0
    return any(_unit(one) in _DISCRETE for one in ast.walk(node))


def _unit(node: ast.AST) -> str:
    """Return the last word of a name of several words; else nothing."""
    name = getattr(node, "id", getattr(node, "attr", ""))
    return name.lower().rpartition("_")[2] if "_" in name else ""


def _is_real(node: ast.expr) -> bool:
    """Return whether an expression is certainly a real number: by its unit, or how it is made."""
    match node:
        case ast.Constant(value=value):
            return isinstance(value, float)
        case ast.BinOp(left=left, right=right):
            return _is_real(left) or _is_real(right)
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
            return name in _REAL_CALLS
    return _unit(node) in _UNITS


def _arithmetic(node: ast.AST) -> Wrong:
    if isinstance(node, ast.BinOp | ast.AugAssign) and type(node.op) in _CALCULATED:
        wrong = copy.deepcopy(node)
        wrong.op = _CALCULATED[type(node.op)]()
        yield "arithmetic", wrong
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "sign", copy.deepcopy(node.operand)


def _product(node: ast.AST) -> Wrong:
    """Swap the operands of a matrix product."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
        wrong = copy.deepcopy(node)
        wrong.left, wrong.right = wrong.right, wrong.left
        yield "swapped product", wrong


def _constant(node: ast.AST) -> Wrong:
    if not isinstance(node, ast.Constant):
        return
    if isinstance(node.value, bool):
        yield "constant", ast.Constant(not node.value)
    elif isinstance(node.value, int):
        yield "off by one", ast.Constant(node.value + 1)
    elif isinstance(node.value, float):
        yield "constant", ast.Constant(2 * node.value if node.value else 1.0)


def _logic(node: ast.AST) -> Wrong:
    if isinstance(node, ast.BoolOp):
        wrong = copy.deepcopy(node)
        wrong.op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        yield "and/or", wrong
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield "not", copy.deepcopy(node.operand)
    if isinstance(node, ast.If | ast.While | ast.IfExp) and not isinstance(node.test, ast.UnaryOp):
        wrong = copy.deepcopy(node)
        wrong.test = ast.UnaryOp(ast.Not(), wrong.test)
        yield "not", wrong


def _returned(node: ast.AST) -> Wrong:
    if not isinstance(node, ast.Return) or node.value is None:
        return
    if not (isinstance(node.value, ast.Constant) and node.value.value is None):
        yield "returned value", ast.Return(ast.Constant(None))


def _removed(node: ast.AST) -> Wrong:
    is_stored = isinstance(node, ast.Assign) and all(
        isinstance(target, ast.Attribute | ast.Subscript) for target in node.targets
    )
    is_call = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
    is_jump = isinstance(node, ast.AugAssign | ast.Raise | ast.Continue | ast.Break | ast.Delete)
    if is_stored or is_call or is_jump:
        yield "removed statement", ast.Pass()


def _index(node: ast.AST) -> Wrong:
    """Shift the bound of a slice or an argument of `range` by one."""
    if isinstance(node, ast.Slice):
        for name in ("lower", "upper"):
            if isinstance(getattr(node, name), ast.Name | ast.Call | ast.BinOp):
                wrong = copy.deepcopy(node)
                setattr(wrong, name, _plus_one(getattr(wrong, name)))
                yield "off by one", wrong
    is_range = isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    if is_range and node.func.id == "range":
        for i, argument in enumerate(node.args):
            if not isinstance(argument, ast.Constant | ast.Starred):
                wrong = copy.deepcopy(node)
                wrong.args[i] = _plus_one(wrong.args[i])
                yield "off by one", wrong


def _plus_one(node: ast.expr) -> ast.expr:
    return ast.BinOp(node, ast.Add(), ast.Constant(1))


OPERATORS: tuple[Callable[[ast.AST], Wrong], ...] = (
    _comparison,
    _arithmetic,
    _product,
    _constant,
    _logic,
    _returned,
    _removed,
    _index,
)


def mistakes(node: ast.AST) -> Wrong:
    """Yield every wrong form of a node, with the kind of mistake."""
    for operator in OPERATORS:
        yield from operator(node)
