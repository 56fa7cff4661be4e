"""The page of the metrics and statistics of campaigns."""

from importlib.metadata import entry_points

from executive import registry
from generators.markdown import NOTE, cell

METRICS = """\
# Metrics and statistics of campaigns

What a campaign can measure on each run, read from what is installed, and how the figures over many
runs come about. A package adds a metric by a class that derives from
`executive.interfaces.metric.Metric` and an entry point in the group `executive.metric.v1`; a metric
reads a run's report and journal ([read a run](how-to/read_a_run.md)). One that raises an error
costs that run this one measurement: the report of the campaign counts such runs and says where the
error was raised.

A **share** counts hits out of trials in each run: stones of a site, attempts, or the run itself.
**Values** are any number of measurements in each run. "Truth" is what the simulator knows, so that
metrics by the truth are for simulated runs only.

A mission reports figures of its own with the leaf `ReportFigure`; the figure `stones_found` is the
metric `figure.stones_found`, whose values are one a run.

A metric of your own, here over an event that a leaf of your own records
([write a tree](how-to/write_a_tree.md)):

```python
from executive.interfaces.metric import Metric, RunRecord, Values

from my_package.events import StoneWeighed


class Weight(Metric):
    title = "mass of a stone"
    unit = "kg"
    description = "Mass of each stone that was weighed."

    def measure(self, run: RunRecord) -> Values | None:
        weighed = [one.event for one in run.events if isinstance(one.event, StoneWeighed)]
        return Values(tuple(event.mass_kg for event in weighed)) if weighed else None
```

```toml
[project.entry-points."executive.metric.v1"]
weight = "my_package.metrics:Weight"
```
"""
STATISTICS = """\
## Statistics

All intervals are of 95 %. What they claim is simulated in
`tests/campaign/figures/test_coverage.py`.

**Nothing is left out.** A run that crashed, was killed or exceeded a limit counts in every share as
the worst: no hit where more is better. How many trials it would have had is taken from a run with
the same seed in another cell, or else from the median of its cell, and the estimate says how many
trials were assumed so. A run that a fault ended counts so in the shares that it could not measure.
Such runs have no values: read the values beside `success`.

**A share of runs** has Wilson's score interval (Wilson 1927).

**A share counted inside runs**, such as `placed`, has Wilson's interval with the effective number
of trials, because the stones of one site resemble each other (Korn & Graubard 1998; Dean & Pagano
2015). It is never narrower than the interval of independent trials.

**Values** are told by their median and their tails: `p90`, `p95`, `max`, `min`. An interval lies
between two of the measured values, whose ranks follow from the binomial distribution, with the
effective number of values where several come from one run (Woodruff 1952). This holds for any
distribution. The bootstrap was tried and does not hold for tails of few runs: resampled values
never exceed the largest one measured, and of a 95th percentile from 20 runs the interval contained
the true one 61 times out of 100, not 95. Where so few runs bound a figure on one side only, the
other end is left open.

**Differences** between a level and its baseline are taken on the same seeds. For shares the
interval is Newcombe's for paired proportions (Newcombe 1998, method 10), extended to shares inside
runs by joining their intervals (Zou & Donner 2008). For values it is that of the median, over
seeds, of the difference between the medians of the two runs. `better` and `worse` are numbers of
seeds, the discordant pairs; the p-value is that of the exact sign test on them, which for shares of
runs is McNemar's. The verdict is one of these:

- `alike`: the whole interval is within the margin of the comparison, so that there is no difference
  that matters.
- `better`, `worse`: the whole interval is on one side of zero. For values also where the sign test
  on the seeds that differ by more than the margin tells a direction, though the median does not:
  more than half of all runs may have no collision at all.
- `too_few`: neither. The number of seeds that would probably tell is given: for a power of 80 %, if
  further seeds are like those seen.

Each verdict stands for itself: of twenty comparisons of variants that are equal, one is told as
better or worse by chance. Decide before the campaign which comparison counts.

With a true difference of 10 points on 100 paired seeds, `worse` is told for `success` with a
probability of 98 % where no seed improves and 10 of 100 get worse, of 80 % with 2 against 12, and
of 60 % with 5 against 15. For `placed`, with seven stones a site, it is told with more than 95 %,
and on 50 seeds with 83 % to 95 %.

**A bound** is met if the figure is within it. It is sure if the whole interval is.
"""


def metrics_page() -> str:
    """Return the page of all metrics, in the order in which the package announces them."""
    rows = ["| metric | what it measures | kind | better | definition |", "|---|---|---|---|---|"]
    for point in entry_points(group=f"executive.{registry.METRICS}.v1"):
        metric = point.load()
        if not metric.__module__.startswith("executive."):
            continue
        unit = f" [{metric.unit}]" if metric.unit else ""
        kind = "share" if metric.is_share else f"values{unit}"
        better = "more" if metric.is_more_better else "less"
        definition = cell(metric.description)
        rows.append(f"| `{point.name}` | {metric.title} | {kind} | {better} | {definition} |")
    return "\n".join([NOTE, METRICS, "## Metrics\n", *rows, "", STATISTICS])
