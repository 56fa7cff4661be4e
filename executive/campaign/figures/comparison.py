"""What a campaign compares with what."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Comparison:
    """The levels of one factor against a baseline, on the same seeds.

    Attributes:
        factor: Name of the factor.
        baseline: The level that the others are compared with.
        metrics: Installed names of the metrics.
        margin: Difference that would matter: in shares 0.05 is five points; relative to the
            baseline's median for values. It decides between "no difference that matters" and "too
            few runs to tell".
    """

    factor: str
    baseline: str
    metrics: tuple[str, ...]
    margin: float = 0.05
