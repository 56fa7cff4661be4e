"""The figures of perception, part by part, and the file that keeps them.

Milliseconds are processor time of one thread.
"""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Figure, judged
from perception.figure_table import FEATURES, ROWS, beside_the_paper, bounds, decoys, piles


def _spent(values_ms: Sequence[float]) -> dict[str, float]:
    return {
        "median": round(float(np.median(values_ms)), 1),
        "p95": round(float(np.percentile(values_ms, 95)), 1),
        "n": len(values_ms),
    }


def swing(seconds: int, count: int = 60) -> dict[str, Any]:
    """Register drawn scenes, seen in a swing so long."""
    from perception.trials import swings

    answers = swings(seconds, count)
    stages = {name for answer in answers for name in answer["timings_ms"]}
    spent = {
        name: _spent([a["timings_ms"].get(name, 0.0) for a in answers]) for name in sorted(stages)
    }
    spent["features"] = _spent(
        [sum(a["timings_ms"].get(name, 0.0) for name in FEATURES) for a in answers]
    )
    errors = np.array(
        [[1e3 * a["error_m"], np.degrees(a["error_rad"])] for a in answers if a["accepted"]]
    )
    return {
        "n": count,
        "right": sum(a["is_right"] for a in answers),
        "wrong_accepted": sum(a["accepted"] and not a["is_right"] for a in answers),
        "error_mm": round(float(np.median(errors[:, 0])), 1),
        "error_deg": round(float(np.median(errors[:, 1])), 3),
        "worst_mm": round(float(errors[:, 0].max()), 1),
        "worst_deg": round(float(errors[:, 1].max()), 3),
        "points": [int(n) for n in np.mean([a["points"] for a in answers], axis=0).round(-3)],
        "timings_ms": spent,
    }


def wrong_sites() -> dict[str, Any]:
    from perception import trials

    return {
        name: {"n": len(answers), "accepted": sum(a["accepted"] for a in answers)}
        for name, answers in trials.wrong_sites(25).items()
    }


def stretched() -> dict[str, Any]:
    from perception import trials

    answers = trials.stretched(10)
    worst = max(a["scale_error"] for a in answers if a["is_right"])
    return {
        "n": len(answers),
        "right": sum(a["is_right"] for a in answers),
        "worst_scale_error": round(worst, 5),
    }


def segmentation() -> dict[str, Any]:
    from perception.trials import segmented

    return _spent(segmented(30))


def same_bits() -> dict[str, Any]:
    from perception import trials

    return trials.same_bits(10)


def neighbours() -> dict[str, Any]:
    """Segment piles of stones."""
    from perception.piles import load_scenes, piles_of

    from trials.neighbours import seen, summed, tallied

    scenes = load_scenes()
    tallies, _ = tallied(lambda seed, gap, shape: piles_of(seed, gap, shape, scenes), 10)
    sums: dict[str, Any] = {"5 cm": summed(tallies, 0.0), "15 cm": summed(tallies, 0.15)}
    kinds = {
        f"{shape}, {100 * low:.0f} to {100 * high:.0f} cm": t
        for (shape, (low, high)), t in tallies.items()
    }
    return {name: {**tally, "n": seen(tally)} for name, tally in (sums | kinds).items()}


def first_success() -> dict[str, Any]:
    from trials.first_success import measured

    times, errors = measured(range(101, 121))
    return {
        "n": len(times),
        "median_s": round(float(np.median(times)), 2),
        "worst_s": round(max(times), 2),
        "error_mm": round(1e3 * float(np.median(errors)), 1),
        "worst_mm": round(1e3 * max(errors), 1),
    }


def scan_pair() -> dict[str, Any]:
    """Feed swings to both mappers."""
    from trials.mapping import recorded
    from trials.mapping_trials import MACHINE, MAPPERS, as_it_is, plugin, trial

    spent: dict[str, list[float]] = {name: [] for name in MAPPERS}
    for seed in (seeds := (1, 2)):
        one = trial("", plugin("estimation", "gnss_imu_filter", machine=MACHINE), MAPPERS, as_it_is)
        for tick in recorded(seed)[0]:
            one.process(tick)
        for name, mapper in one.fan.mappers.items():
            spent[name] += one.fan.pair_ms[name]
            mapper.close()
    late = {name: round(float(np.percentile(values, 95)), 1) for name, values in spent.items()}
    return {"p95_ms": late | {"n": len(seeds)}, "pairs": len(spent[MAPPERS[0]])}


PARTS: dict[str, Callable[[], dict[str, Any]]] = {
    "swing_20_s": lambda: swing(20),
    "swing_10_s": lambda: swing(10),
    "wrong_sites": wrong_sites,
    "stretched": stretched,
    "segmentation": segmentation,
    "same_bits": same_bits,
    "neighbours": neighbours,
    "first_success": first_success,
    "scan_pair": scan_pair,
}


def tables(figures: dict[str, Any]) -> list[str]:
    """Return the tables that can be made of what was measured."""
    made = [bounds(figures)]
    made += [beside_the_paper(figures)] if "swing_20_s" in figures else []
    made += [decoys(figures)] if "wrong_sites" in figures else []
    made += [piles(figures)] if "neighbours" in figures else []
    return made


def keep(part: str, figures: dict[str, Any], kept: Path) -> None:
    """Replace one part of what a file keeps."""
    everything = read(kept) if kept.exists() else {}
    kept.write_text(json.dumps(everything | {part: figures}, indent=1, sort_keys=True) + "\n")


def read(kept: Path) -> dict[str, Any]:
    """Return what a file keeps."""
    figures: dict[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
    return figures


def held(figures: dict[str, Any]) -> list[Figure]:
    """Return the figures that were measured, with their bounds."""
    return [
        judged(row.what, row.told(figures), row.must, row.is_met(figures))
        for row in ROWS
        if all(part in figures for part in row.parts)
    ]
