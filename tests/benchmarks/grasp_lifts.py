"""How often a mission's grasps succeed: whole missions, the machine's own arm and jaws, what its
sensors saw.

    python tests/benchmarks/grasp_lifts.py FOLDER run generated learned 1:16
    python tests/benchmarks/grasp_lifts.py FOLDER run SCANS learned 1:6 --scale 10
    python tests/benchmarks/grasp_lifts.py FOLDER table

Each site is one `pick_and_place` of seven stones: seeds 1001, 1002, … of generated ones, or seven
scans of a folder SCANS, in an order of seed 0, none twice, those left out that are heavier than the
payload. Rankings see the same sites. FOLDER/lifts.jsonl gets a line a stone; sites that are there
already are skipped: a run goes on where it stopped.

An attempt is a success if the mission says that the stone was placed and the simulator that it was
lifted and not dropped: picked up, carried to its slot, set down. Stones that were found and for
which there was no attempt count as failures. Intervals: Wilson, 95 %.
"""

import argparse
import hashlib
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from executive_plugins.grasping.sampled_cnn import weights_file
from executive_plugins.robot.mujoco.site.mass_properties import volume_and_centroid
from executive_plugins.robot.mujoco.site.stone_meshes import mesh_files, read_skin

from executive.clock import wall_s
from executive.machine.machine import load_machine
from executive.mission.mission import Mission
from executive.mission.run import Options, Run
from executive.tree.load import load_mission

A_SITE, FIRST_SEED, DENSITY, FLAT, TRIES = 7, 1000, 2700.0, 0.5, 3
RANKINGS = {
    "learned": ("grasping.plugin=sampled_cnn",),
    "paper": ("grasping.plugin=sampled_antipodal", "grasping.rehearsed=0"),
    "rehearsal": ("grasping.plugin=sampled_antipodal",),
}


def scans_of(folder: Path, scale: float, site: int) -> list[Path]:
    """Return the files of one site, numbered from 1."""
    most_m3 = load_machine("m545").payload_kg / DENSITY
    files = [
        f for f in mesh_files(folder) if volume_and_centroid(*read_skin(f, scale))[0] <= most_m3
    ]
    order = np.random.default_rng(0).permutation(len(files))
    return [files[i] for i in order[A_SITE * (site - 1) : A_SITE * site]]


def run_site(
    stones: str, scale: float, ranking: str, site: int, folder: Path
) -> list[dict[str, Any]]:
    """Run the mission of one site and return a row a stone."""
    settings = [*RANKINGS[ranking], f"robot.site.stones.count={A_SITE}"]
    if stones != "generated":
        meshes = folder / "meshes"
        meshes.mkdir()
        for file in scans_of(Path(stones), scale, site):
            (meshes / file.name).symlink_to(file.resolve())
        settings += [
            f"robot.site.stones.folder={json.dumps(str(meshes))}",
            f"robot.site.stones.scale={scale}",
        ]
    shapes: dict[int, tuple[float, float]] = {}

    def look(mission: Mission) -> None:
        if not shapes:
            shapes.update(shapes_of(mission.services.plugins["robot"].world.model))

    begun_s = wall_s()
    made = Run(
        load_mission("pick_and_place", settings),
        Options(seed=FIRST_SEED + site, run_dir=folder / "run"),
    )
    report = made.execute(look).report
    if report["outcome"] in ("stopped", "fault"):
        sys.exit(
            f"{stones} {ranking} site {site}: {report['outcome']}: {report['reason']}; "
            "nothing is noted"
        )
    about = {
        "stones": "generated" if stones == "generated" else "scanned",
        "ranking": ranking,
        "site": site,
    }
    about |= {
        "weights": weights_id() if ranking == "learned" else "",
        "wall_s": round(wall_s() - begun_s),
    }
    about |= {"plan_ms": report["timings_ms"].get("grasping.plan", {})}
    return [about | row for row in rows_of(report, shapes)]


def rows_of(
    report: dict[str, Any], shapes: dict[int, tuple[float, float]]
) -> Iterator[dict[str, Any]]:
    """Yield what became of each stone: its shape, and its attempts in order."""
    truth = report["truth"]
    lifted = {key(a, p): g for (a, p), g in zip(by_time(report), truth["grasps"], strict=True)}
    for stone in truth["stones"]:
        picks = [pick for pick in report["picks"] if pick["object"] == stone["held_object"]]
        flatness, mass_kg = shapes[stone["id"]]
        yield {
            "stone": stone["id"],
            "flatness": round(flatness, 3),
            "mass_kg": round(mass_kg),
            "found": stone["held_object"] is not None,
            "set_aside": picks[0]["set_aside"] if picks else "never selected",
            "attempts": [
                {
                    "outcome": attempt["outcome"],
                    "reason": attempt["reason"],
                    "lifted": lifted[key(attempt, pick)]["lifted"],
                    "dropped": lifted[key(attempt, pick)]["dropped"],
                    "score": round(attempt["grasp"]["score"], 3),
                    "costs": {
                        name: round(cost, 3) for name, cost in attempt["grasp"]["costs"].items()
                    },
                }
                for pick in picks[:1]
                for attempt in pick["attempts"]
            ],
        }


def by_time(report: dict[str, Any]) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """Return attempts with their picks in the order of the report's true grasps."""
    pairs = [(attempt, pick) for pick in report["picks"] for attempt in pick["attempts"]]
    return sorted(pairs, key=lambda pair: pair[0]["started_s"])


def key(attempt: dict[str, Any], pick: dict[str, Any]) -> tuple[int, float]:
    return pick["object"], attempt["started_s"]


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
    """Return the table in Markdown: a line a kind of stones and ranking."""
    lines = [
        "| stones | ranking | first attempt | flat ones | within three attempts |",
        "|---|---|---|---|---|",
    ]
    for stones, ranking, weights in sorted(
        {(r["stones"], r["ranking"], r["weights"]) for r in rows}
    ):
        of = [
            r
            for r in rows
            if (r["stones"], r["ranking"], r["weights"]) == (stones, ranking, weights)
            and r["found"]
        ]
        first = [bool(r["attempts"]) and is_success(r["attempts"][0]) for r in of]
        flat = [good for r, good in zip(of, first, strict=True) if r["flatness"] < FLAT]
        three = [any(is_success(a) for a in r["attempts"][:TRIES]) for r in of]
        name = f"{ranking} {weights}".strip()
        lines.append(f"| {stones} | {name} | {rate(first)} | {rate(flat)} | {rate(three)} |")
        ends = Counter(r["attempts"][0]["outcome"] if r["attempts"] else r["set_aside"] for r in of)
        lines.append(
            "|  | first attempts: "
            f"{', '.join(f'{n} {what}' for what, n in ends.most_common())} | | | |"
        )
    return "\n".join(lines)


def arguments(doc: str | None) -> argparse.Namespace:
    """Read the command line of a benchmark that runs sites,
    or lays out the table of what was run.
    """
    parser = argparse.ArgumentParser(
        description=doc, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verbs.add_parser("table")
    run = verbs.add_parser("run")
    run.add_argument("stones", help="`generated`, or a folder of meshes")
    run.add_argument("ranking", choices=RANKINGS)
    run.add_argument("sites", help="first and last and one, such as 1:16")
    run.add_argument("--scale", type=float, default=1.0)
    return parser.parse_args()


def main() -> None:
    given = arguments(__doc__)
    given.folder.mkdir(exist_ok=True, parents=True)
    path = given.folder / "lifts.jsonl"
    rows = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    if given.verb == "table":
        print(table(rows))
        return
    kind = "generated" if given.stones == "generated" else "scanned"
    weights = weights_id() if given.ranking == "learned" else ""
    done = {(r["stones"], r["ranking"], r["weights"], r["site"]) for r in rows}
    for site in range(*map(int, given.sites.split(":"))):
        if (kind, given.ranking, weights, site) in done:
            continue
        with tempfile.TemporaryDirectory() as folder:
            found = run_site(given.stones, given.scale, given.ranking, site, Path(folder))
        with path.open("a") as file:
            file.writelines(json.dumps(row) + "\n" for row in found)
        first = [bool(row["attempts"]) and is_success(row["attempts"][0]) for row in found]
        print(
            f"{kind} {given.ranking} site {site}: {sum(first)} of {len(first)}, "
            f"{found[0]['wall_s']} s",
            flush=True,
        )


if __name__ == "__main__":
    main()
