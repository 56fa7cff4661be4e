"""A campaign, checked: what is run, measured, bounded and compared."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.campaign.figures.bound import Bound
from executive.campaign.figures.comparison import Comparison
from executive.campaign.trial import Trial


@dataclass(frozen=True, slots=True)
class Campaign:
    """What `executive campaign` was asked for.

    Attributes:
        name: The campaign's name.
        description: What it answers, in a sentence.
        trials: Every run, in the order in which they are begun: seed by seed, so that a campaign
            that is stopped early has whole pairs.
        factors: Levels by factor, in the order in which they were given; a campaign of one cell
            has none.
        metrics: Installed names of the metrics that are reported, in order.
        bounds: Limits on figures; one that is missed ends the campaign with status 1.
        comparisons: What is compared with what.
        digest: Hash over the trials without their limits; results of another digest are not
            continued. Arguments hold whole missions, so that a changed mission has another digest.
        command: The command line that made it, for the report.
        text: The campaign file with all options in it and absolute paths, which gives the same
            trials; it is kept as `campaign.yaml`.
        warnings: What works but was hardly meant, each with its place.
    """

    name: str
    description: str
    trials: tuple[Trial, ...]
    factors: Mapping[str, tuple[str, ...]]
    metrics: tuple[str, ...]
    bounds: tuple[Bound, ...]
    comparisons: tuple[Comparison, ...]
    digest: str
    command: str
    text: str = ""
    warnings: tuple[str, ...] = ()
