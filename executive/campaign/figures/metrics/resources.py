"""Metrics of what a run takes from the computer."""

from executive.interfaces.metric import Metric, RunRecord, Values


class CpuPerSimulatedSecond(Metric):
    """Processor time for each second of the mission."""

    title = "processor time a simulated second"
    is_more_better = False
    description = (
        "Processor time of a run and of its worker processes [s], without what compiling takes,"
        " divided by the mission time [s]. One that is computed on another processor is not"
        " comparable."
    )

    def measure(self, run: RunRecord) -> Values | None:
        taken, ended_s = run.report.resources, run.report.ended_s
        spent_s = taken.cpu_s - (taken.compiling_s or 0.0)
        return Values((spent_s / ended_s,)) if ended_s > 0 else None


class PeakMemory(Metric):
    """Largest memory of a run."""

    title = "peak memory"
    unit = "byte"
    is_more_better = False
    description = (
        "Largest resident memory of the process of a run, and of the largest of its worker"
        " processes, together."
    )

    def measure(self, run: RunRecord) -> Values:
        return Values((run.report.resources.peak_memory_bytes,))


class WallTime(Metric):
    """Duration of a run on the wall."""

    title = "wall time"
    unit = "s"
    is_more_better = False
    description = (
        "Duration of a run on the wall, from building the site to the end of the mission. It"
        " depends on what else the computer does."
    )

    def measure(self, run: RunRecord) -> Values:
        return Values((run.report.wall_s,))


class RealTimeFactor(Metric):
    """How much faster than reality a run is."""

    title = "real-time factor"
    description = "Mission time divided by wall time. It depends on what else the computer does."

    def measure(self, run: RunRecord) -> Values:
        return Values((run.report.real_time_factor,))
