"""Lay three estimators side by side on simulated measurements that go wrong in every way, as a
table in Markdown.

    python tests/benchmarks/estimation_faults.py
    python tests/benchmarks/estimation_faults.py --seeds 1:4 --scenarios spikes,ramp --estimators
    dual_graph python tests/benchmarks/estimation_faults.py --keep figures.jsonl     # goes on where
    it was broken off python tests/benchmarks/estimation_faults.py --timing                 # how
    long they take, in real time: 3 minutes

Cells show median … worst over the trials, or mean ± standard deviation; bold is a must that is
missed, a star a stretch that is reached; of timings, median … best of blocks of three seconds in
which the estimators take turns. The estimators are fed directly, with default settings but for what
a scenario says.
"""

import argparse
import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from executive_plugins.estimation.filters.error_state_ekf import ErrorStateEkf
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.graph.dual_graph import DualGraph
from scenarios import timing
from scenarios.motion import Motion
from scenarios.scenario import SCENARIOS
from scenarios.streams import LidarErrors, stream
from scenarios.table import ROWS, TIMING_ROWS, Values, table
from scenarios.trial import Trial
from scenarios.truth import Truth

from executive.interfaces.estimation import Estimator
from executive.machine.machine import Machine, load_machine

ESTIMATORS = {
    "dual_graph": DualGraph,
    "error_state_ekf": ErrorStateEkf,
    "gnss_imu_filter": GnssImuFilter,
}


def trials(
    name: str, seed: int, estimators: Sequence[str], machine: Machine
) -> Iterator[tuple[str, Trial]]:
    """Yield each estimator's trial on the same measurements."""
    scenario = SCENARIOS[name]
    rng = np.random.default_rng([seed, *name.encode()])
    motion = Motion.drawn(scenario.kinds[seed % len(scenario.kinds)], rng)
    truth = Truth(machine, motion)
    messages = stream(
        truth, scenario.end_s, scenario.fault(rng), LidarErrors() if scenario.lidar else None, rng
    )
    for estimator in estimators:
        kind = ESTIMATORS[estimator]
        yield (
            estimator,
            Trial.run(kind(kind.Settings(**scenario.settings), machine), truth, messages),
        )


def read(path: Path | None) -> list[Mapping[str, object]]:
    """Return the figures that were kept."""
    if path is None or not path.exists():
        return []
    return [json.loads(line) for line in path.read_text().splitlines()]


def gathered(records: Sequence[Mapping[str, object]]) -> Values:
    """Gather figures by estimator and name."""
    values: dict[str, dict[str, list[float]]] = {name: defaultdict(list) for name in ESTIMATORS}
    for record in records:
        for name, value in record["figures"].items():
            values[record["estimator"]][name].append(float(value))
    return {name: figures for name, figures in values.items() if figures}


def timings(machine: Machine) -> str:
    """Return the table of durations; the smoother in a process of its own, but for its updates."""

    def made(name: str, is_apart: bool) -> Estimator:
        kind = ESTIMATORS[name]
        return kind(
            kind.Settings(process=is_apart) if name == "dual_graph" else kind.Settings(), machine
        )

    before = timing.computer()
    values = timing.service({name: partial(made, name) for name in ESTIMATORS}, machine)
    values["dual_graph"] |= timing.updates(partial(made, "dual_graph"), machine)
    return f"{table(TIMING_ROWS, values)}\n\nBefore: {before}. After: {timing.computer()}."


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", default="1:10", help="first and last seed, A:B")
    parser.add_argument("--scenarios", default=",".join(SCENARIOS))
    parser.add_argument("--estimators", default=",".join(ESTIMATORS))
    parser.add_argument(
        "--keep",
        type=Path,
        help="file of figures, one trial a line; trials in it are not run again",
    )
    parser.add_argument("--timing", action="store_true", help="measure durations instead")
    arguments = parser.parse_args()
    if arguments.timing:
        print(timings(load_machine("m545")))
        return
    first, last = (int(seed) for seed in arguments.seeds.split(":"))
    machine = load_machine("m545")
    records = read(arguments.keep)
    done = {(r["scenario"], r["seed"], r["estimator"]) for r in records}
    for seed in range(first, last + 1):
        for scenario in arguments.scenarios.split(","):
            wanted = [e for e in arguments.estimators.split(",") if (scenario, seed, e) not in done]
            for estimator, trial in trials(scenario, seed, wanted, machine) if wanted else ():
                figures = dict(SCENARIOS[scenario].figures(trial))
                record = {
                    "scenario": scenario,
                    "seed": seed,
                    "estimator": estimator,
                    "figures": figures,
                }
                records.append(record)
                if arguments.keep is not None:
                    with arguments.keep.open("a") as file:
                        file.write(json.dumps(record) + "\n")
    print(table(ROWS, gathered(records)))


if __name__ == "__main__":
    main()
