"""Three estimators on simulated measurements that go wrong in every way."""

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from bounds import Figure
from executive_plugins.estimation.filters.error_state_ekf import ErrorStateEkf
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.graph.dual_graph import DualGraph
from scenarios import timing
from scenarios.motion import Motion
from scenarios.scenario import SCENARIOS
from scenarios.streams import LidarErrors, stream
from scenarios.table import ROWS, TIMING_ROWS, Values, figures, table
from scenarios.trial import Trial
from scenarios.truth import Truth

from executive.interfaces.estimation import Estimator
from executive.machine.machine import Machine, load_machine

ESTIMATORS = {
    "dual_graph": DualGraph,
    "error_state_ekf": ErrorStateEkf,
    "gnss_imu_filter": GnssImuFilter,
}
HELD = "dual_graph"  # the bounds are for this estimator; the others stand beside it


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


def timings() -> list[Figure]:
    """Print the table of durations, the smoother in a process of its own but for its updates, and
    return the figures that are held to the bounds.
    """
    machine = load_machine("m545")

    def made(name: str, is_apart: bool) -> Estimator:
        kind = ESTIMATORS[name]
        return kind(
            kind.Settings(process=is_apart) if name == "dual_graph" else kind.Settings(), machine
        )

    before = timing.computer()
    values = timing.service({name: partial(made, name) for name in ESTIMATORS}, machine)
    values["dual_graph"] |= timing.updates(partial(made, "dual_graph"), machine)
    print(f"{table(TIMING_ROWS, values)}\n\nBefore: {before}. After: {timing.computer()}.")
    return figures(TIMING_ROWS, values, HELD)


def faults(
    seeds: Sequence[int], scenarios: Sequence[str], estimators: Sequence[str], kept: Path | None
) -> list[Figure]:
    """Run the trials that are not in the kept file, print the table, and return the figures that
    are held to the bounds: of `dual_graph`, or of the only estimator.
    """
    machine = load_machine("m545")
    records = list(read(kept))
    done = {(r["scenario"], r["seed"], r["estimator"]) for r in records}
    for seed in seeds:
        for scenario in scenarios:
            wanted = [e for e in estimators if (scenario, seed, e) not in done]
            for estimator, trial in trials(scenario, seed, wanted, machine) if wanted else ():
                record = {
                    "scenario": scenario,
                    "seed": seed,
                    "estimator": estimator,
                    "figures": dict(SCENARIOS[scenario].figures(trial)),
                }
                records.append(record)
                if kept is not None:
                    with kept.open("a") as file:
                        file.write(json.dumps(record) + "\n")
    values = gathered(records)
    print(table(ROWS, values))
    return figures(ROWS, values, HELD if HELD in values else next(iter(values)))
