"""What the truth of runs says of limits and collisions."""

from collections.abc import Iterator, Sequence

from bounds import Bound, Figure, held

from trials.ended import Ended

NEVER = Bound(0)
KINDS = ("tipping", "flow", "position", "speed", "effort")


def figures(runs: Sequence[Ended], least_cycles: int) -> list[Figure]:
    """Return the figures of all runs together."""
    blind = [run.folder.name for run in runs if not run.is_observed]
    cycles = sum(run.cycles for run in runs)
    ground = sum(run.truth.get("ground_contacts") or 0 for run in runs)
    return [
        held("cycles", cycles, Bound(least_cycles, is_least=True), f"{cycles} in {len(runs)} runs"),
        held("runs of which limits or collisions are not known", len(blind), NEVER, _names(blind)),
        _collisions(runs),
        *(_limit(runs, kind) for kind in KINDS),
        Figure(
            "contacts of gripper or jaws with the ground, none of them a collision", str(ground)
        ),
    ]


def _collisions(runs: Sequence[Ended]) -> Figure:
    met = [
        f"{one['bodies'][0]} with {one['bodies'][1]} in {run.folder.name} at {one['from_s']:.1f} s"
        for run in runs
        for one in run.truth.get("collisions") or ()
    ]
    return held("collisions", len(met), NEVER, _names(met))


def _limit(runs: Sequence[Ended], kind: str) -> Figure:
    """Return how often a kind of limit was passed, and its largest share."""
    uses = [(one, run) for run in runs for one in run.limits if one["kind"] == kind]
    times = sum(one["times_beyond"] for one, _ in uses)
    if kind == "tipping":
        times += sum(run.has_tipped for run in runs)
    what = f"times beyond the limit: {kind}"
    if not uses:
        return held(what, times, NEVER, f"{times}, nothing observed it")
    most, run = max(uses, key=lambda use: float(use[0]["largest_share"]))
    beyond_s = sum(one["beyond_s"] for one, _ in uses)
    share = f"largest share {most['largest_share']:.4f}, {most['of']}"
    told = f"{times}, {beyond_s:.2f} s in all" if times else "0"
    return held(what, times, NEVER, f"{told} ({share} in {run.folder.name})")


def _names(found: Sequence[str]) -> str:
    """Return a number and the first of what was found."""
    return "; ".join([str(len(found)), *_few(found)])


def _few(found: Sequence[str]) -> Iterator[str]:
    yield from found[:3]
    if len(found) > 3:
        yield "…"
