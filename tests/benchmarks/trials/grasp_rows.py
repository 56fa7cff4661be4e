"""Sites on which grasps are counted: their stones, a row a stone, and the table of all rows.

An attempt is a success if it says that the stone was placed and the simulator that it was lifted
and not dropped: picked up, carried, set down. Stones that were found and for which there was no
attempt count as failures. Intervals: Wilson, 95 %.
"""

import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.grasping.classifier.weights_file import weights_file
from executive_plugins.robot.mujoco.site.stone_meshes import mesh_files, read_skin

from executive.geometry.solid import volume_and_centroid
from executive.machine.machine import load_machine

A_SITE, FIRST_SEED, DENSITY, FLAT, TRIES = 7, 1000, 2700.0, 0.5, 3
RANKINGS = {
    "learned": ("grasping.plugin=sampled_cnn",),
    "paper": ("grasping.plugin=sampled_antipodal", "grasping.rehearsed=0"),
    "rehearsal": ("grasping.plugin=sampled_antipodal",),
}
# Shares of stones at the first attempt and within three; the latter pair for worlds that are worse
# than the one for which grasps are planned.
WORSE = ("wet", "harsh")
BOUNDS = (
    (Bound(0.90, 0.96, is_least=True), Bound(0.99, 1.0, is_least=True)),
    (Bound(0.75, 0.85, is_least=True), Bound(0.95, 0.99, is_least=True)),
)
FLAT_ONES = Bound(0.85, 0.93, is_least=True)  # at the first attempt
ABOVE_THE_PAPER = Bound(10, 20, is_least=True)  # points, on stones that both have tried


@dataclass(frozen=True, slots=True)
class World:
    """Where grasps are tried.

    Attributes:
        stones: `generated`, or a folder of meshes.
        scale: Factor on the meshes of the folder.
        scenario: Physics of the simulated world.
    """

    stones: str
    scale: float = 1.0
    scenario: str = "nominal"

    @property
    def kind(self) -> str:
        return "generated" if self.stones == "generated" else "scanned"


def scans_of(folder: Path, scale: float, site: int) -> list[Path]:
    """Return the files of one site, numbered from 1."""
    most_m3 = load_machine("m545").payload_kg / DENSITY
    files = [
        f for f in mesh_files(folder) if volume_and_centroid(*read_skin(f, scale))[0] <= most_m3
    ]
    order = np.random.default_rng(0).permutation(len(files))
    return [files[i] for i in order[A_SITE * (site - 1) : A_SITE * site]]


def shapes_of(model: Any) -> dict[int, tuple[float, float]]:
    """Return the shortest over the middle of the skin's principal extents, and the mass [kg], by
    the stone's number.
    """
    shapes = {}
    for i in range(1, A_SITE + 1):
        mesh = model.mesh(f"stone_{i}_skin").id
        first, n = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        skin = model.mesh_vert[first : first + n].astype(float)
        _, _, axes = np.linalg.svd(skin - skin.mean(axis=0), full_matrices=False)
        extents = np.sort(np.ptp(skin @ axes.T, axis=0))
        shapes[i] = float(extents[0] / extents[1]), float(model.body(f"stone_{i}").mass[0])
    return shapes


def weights_id() -> str:
    return hashlib.sha256(weights_file("two_stream").read_bytes()).hexdigest()[:8]


def is_success(attempt: dict[str, Any]) -> bool:
    return bool(attempt["outcome"] == "placed" and attempt["lifted"] and not attempt["dropped"])


def is_first(row: dict[str, Any]) -> bool:
    return bool(row["attempts"]) and is_success(row["attempts"][0])


def is_within_three(row: dict[str, Any]) -> bool:
    return any(is_success(attempt) for attempt in row["attempts"][:TRIES])


def world_of(row: dict[str, Any]) -> tuple[str, float, str]:
    return row["stones"], row["scale"], row["scenario"]


def kind_of(row: dict[str, Any]) -> tuple[str, str, str, str]:
    return row["stones"], row["scenario"], row["ranking"], row["weights"]


def wilson(k: int, n: int, z: float = 1.96) -> tuple[float, float]:
    """Return the 95 % interval of a rate."""
    middle, half = (
        (k + z * z / 2) / (n + z * z),
        z * np.sqrt(k * (n - k) / n + z * z / 4) / (n + z * z),
    )
    return float(middle - half), float(middle + half)


def rate(good: Iterable[bool]) -> str:
    found = list(good)
    if not found:
        return "-"
    low, high = wilson(sum(found), len(found))
    return (
        f"{sum(found)}/{len(found)} = {100 * sum(found) / len(found):.0f} % "
        f"[{100 * low:.0f}, {100 * high:.0f}]"
    )


def table(rows: list[dict[str, Any]]) -> str:
    """Return the table in Markdown: a line for each kind of stones and ranking."""
    lines = [
        "| stones | world | ranking | first attempt | flat ones | within three attempts |",
        "|---|---|---|---|---|---|",
    ]
    for kind in sorted({kind_of(r) for r in rows}):
        stones, scenario, ranking, weights = kind
        of = [r for r in rows if kind_of(r) == kind and r["found"]]
        first = [is_first(r) for r in of]
        flat = [good for r, good in zip(of, first, strict=True) if r["flatness"] < FLAT]
        three = [is_within_three(r) for r in of]
        name = f"{ranking} {weights}".strip()
        rates = " | ".join(map(rate, (first, flat, three)))
        lines.append(f"| {stones} | {scenario} | {name} | {rates} |")
        ends = Counter(r["attempts"][0]["outcome"] if r["attempts"] else r["set_aside"] for r in of)
        lines.append(
            "|  | | first attempts: "
            f"{', '.join(f'{n} {what}' for what, n in ends.most_common())} | | | |"
        )
    return "\n".join(lines)


def figures(rows: list[dict[str, Any]]) -> list[Figure]:
    """Hold the learned ranking against its bounds, and against the paper's where both were run."""
    made = []
    for stones, scenario in sorted({(r["stones"], r["scenario"]) for r in rows}):
        there = [r for r in rows if (r["stones"], r["scenario"]) == (stones, scenario)]
        of = [r for r in there if r["ranking"] == "learned" and r["found"]]
        flat = [r for r in of if r["flatness"] < FLAT and scenario not in WORSE]
        first, three = BOUNDS[scenario in WORSE]
        for what, some, is_good, least in (
            ("placed at the first attempt", of, is_first, first),
            ("flat ones", flat, is_first, FLAT_ONES),
            ("placed within three attempts", of, is_within_three, three),
        ):
            if some:
                good = [is_good(r) for r in some]
                told = f"{stones}, {scenario}: {what}"
                made.append(held(told, np.mean(good), least, rate(good)))
        made += _above_the_paper(f"{stones}, {scenario}", of, there)
    return made


def _above_the_paper(
    told: str, learned: list[dict[str, Any]], rows: list[dict[str, Any]]
) -> Iterator[Figure]:
    """Yield the difference at the first attempt on the stones that both rankings have tried."""
    paper = {
        (r["scale"], r["site"], r["stone"]): is_first(r)
        for r in rows
        if r["ranking"] == "paper" and r["found"]
    }
    pairs = [
        (is_first(r), paper[r["scale"], r["site"], r["stone"]])
        for r in learned
        if (r["scale"], r["site"], r["stone"]) in paper
    ]
    if pairs:
        ours, theirs = 100 * np.mean(pairs, axis=0)
        yield held(
            f"{told}: above the paper's order, same stones [points]",
            float(ours - theirs),
            ABOVE_THE_PAPER,
            f"{ours - theirs:.0f} (n = {len(pairs)})",
        )


def read(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a file; none where there is no file yet."""
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
