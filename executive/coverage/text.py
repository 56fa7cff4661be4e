"""Coverage as people read it, and as programs do."""

from collections.abc import Iterator
from typing import Any

from executive.coverage.branch import ENDS, Branch, Limb
from executive.coverage.coverage import Coverage

_IMPOSSIBLE, _LONGEST = "·", 40  # a branch that does not exist; lines of the list at the end


def coverage_text(coverage: Coverage, *, lists_never: bool = True) -> str:
    """Return a line for each node that was reached, and the branches that no run has taken."""
    heads = [*(end.value for end in ENDS), "halted"]
    lines = [" ".join(f"{head:>7}" for head in heads) + "  node"]
    lines += [_line(coverage, limb) for limb in coverage.limbs if coverage.is_reached(limb)]
    end = [_summary(coverage), *(_never(coverage) if lists_never else ())]
    return "\n".join([*lines, "", *end])


def coverage_answer(coverage: Coverage) -> dict[str, Any]:
    """Return the same as JSON."""
    return {
        "mission": coverage.mission,
        "runs": [
            {
                "run": run.name,
                "dry": run.is_dry,
                "outcome": run.outcome or None,
                "reason": run.reason,
                "ended_s": run.ended_s,
            }
            for run in coverage.runs
        ],
        "branches": len(coverage.branches),
        "taken": len(coverage.branches) - len(coverage.never),
        "percent": round(coverage.percent, 2),
        "nodes": [_node(coverage, limb) for limb in coverage.limbs],
        "never": [{"path": one.path, "what": one.what} for one in coverage.never],
    }


def _line(coverage: Coverage, limb: Limb) -> str:
    ends = _ends(coverage, limb)
    counts = [ends.get(end.value, _IMPOSSIBLE) for end in ENDS]
    cells = " ".join(f"{count:>7}" for count in [*counts, coverage.halted(limb)])
    effects = ", ".join(
        f"{one.what} {coverage.count(one)}" for one in limb.branches if one.path != limb.path
    )
    return f"{cells}  {'  ' * limb.depth}{limb.name}{f'  ({effects})' if effects else ''}"


def _summary(coverage: Coverage) -> str:
    total, count = len(coverage.branches), len(coverage.runs)
    dry = sum(run.is_dry for run in coverage.runs)
    kind = "dry " if dry == count else ""
    runs = f"{count} {kind}run{'' if count == 1 else 's'}"
    mixed = f", {dry} of them dry" if 0 < dry < count else ""
    taken = total - len(coverage.never)
    return f"{taken} of {total} branches taken by {runs}{mixed} ({coverage.percent:.0f} %)"


def _never(coverage: Coverage) -> Iterator[str]:
    never = _without_those_below(coverage)
    if never:
        yield "never taken:"
    yield from (f"  {line}" for line in never[:_LONGEST])
    if len(never) > _LONGEST:
        yield f"  and {len(never) - _LONGEST} more; --json lists all"


def _without_those_below(coverage: Coverage) -> list[str]:
    """Return the branches that were never taken; of a node never ticked, one line for all below."""
    lines: list[str] = []
    hidden: Limb | None = None
    for limb in coverage.limbs:
        if hidden is not None and limb.depth > hidden.depth:
            continue
        hidden = None
        never = [one for one in limb.branches if not coverage.count(one)]
        if coverage.is_ticked(limb):
            lines += [str(one) for one in never]
        else:
            hidden = limb
            lines.append(f"{limb.path}: never ticked")
    return lines


def _ends(coverage: Coverage, limb: Limb) -> dict[str, int]:
    """Return how often a node ended in each way that it can, or did by a mistake."""
    own = {one.what for one in limb.branches if one.path == limb.path}
    counts = {end.value: coverage.count(Branch(limb.path, end.value)) for end in ENDS}
    return {what: count for what, count in counts.items() if what in own or count}


def _node(coverage: Coverage, limb: Limb) -> dict[str, Any]:
    effects = [one for one in limb.branches if one.path != limb.path]
    return {
        "path": limb.path,
        "name": limb.name,
        "ticked": coverage.is_ticked(limb),
        "ends": _ends(coverage, limb),
        "effects": {one.what: coverage.count(one) for one in effects},
        "halted": coverage.halted(limb),
    }
