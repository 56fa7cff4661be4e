"""What all benchmarks share: figures held against bounds, the table of both, and the exit status.

A benchmark reads its command line with `command_line`, measures, and ends with `verdict`: the
table on standard output, the misses on standard error, and the exit status.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

HOLDS, MISSED = 0, 1  # argparse ends with 2 on wrong input
STATUSES = (
    "Exit status: 0 if every bound holds, 1 if one is missed, 2 if the input is wrong.\n"
    "docs/benchmarks.md lists all benchmarks with their bounds."
)


@dataclass(frozen=True, slots=True)
class Bound:
    """A limit on a figure.

    Attributes:
        must: What the figure has to reach; beyond it the benchmark fails.
        stretch: What was hoped for; it is reported and decides nothing.
        is_least: Whether both are lower bounds.
    """

    must: float
    stretch: float | None = None
    is_least: bool = False

    def holds(self, value: float) -> bool:
        """Return whether a value is within the bound; NaN never is."""
        return self._is_within(value, self.must)

    def is_stretched(self, value: float) -> bool:
        """Return whether a value reaches the stretch, where there is one."""
        return self.stretch is not None and self._is_within(value, self.stretch)

    def _is_within(self, value: float, limit: float) -> bool:
        room = 1e-9 * max(1.0, abs(limit))  # a sum of binary fractions is not taken for a miss
        return value >= limit - room if self.is_least else value <= limit + room

    def __str__(self) -> str:
        return f"{'≥' if self.is_least else '≤'} {self.must:.4g}"


@dataclass(frozen=True, slots=True)
class Figure:
    """One line of a benchmark's table.

    Attributes:
        what: What was measured, with its unit.
        value: The figure in words.
        bound: The bound in words; empty where there is none.
        verdict: `met`, `stretch` or `missed`; empty where there is no bound.
    """

    what: str
    value: str
    bound: str = ""
    verdict: str = ""

    @property
    def is_missed(self) -> bool:
        """Whether the figure misses its bound."""
        return self.verdict == "missed"


def held(what: str, value: float, bound: Bound, words: str | None = None) -> Figure:
    """Hold a value against its bound.

    Args:
        what: What was measured, with its unit.
        value: The figure; NaN or infinite where nothing came of it, which misses every bound but
            an infinite least one.
        bound: The bound, in the same unit.
        words: How the figure is written, such as with its number of trials; by default the number.
    """
    verdict = "missed"
    if bound.holds(value):
        verdict = "stretch" if bound.is_stretched(value) else "met"
    return Figure(what, f"{value:.4g}" if words is None else words, str(bound), verdict)


def judged(what: str, words: str, bound: str, is_met: bool) -> Figure:
    """Return a figure whose bound is not one number, such as `all of them`."""
    return Figure(what, words, bound, "met" if is_met else "missed")


def table(figures: Sequence[Figure]) -> str:
    """Return the figures beside their bounds, as Markdown."""
    lines = ["| figure | measured | bound | verdict |", "|---|---|---|---|"]
    for one in figures:
        value, verdict = (
            (f"**{text}**" if one.is_missed else text) for text in (one.value, one.verdict)
        )
        lines.append(f"| {one.what} | {value} | {one.bound} | {verdict} |")
    return "\n".join(lines)


def verdict(figures: Sequence[Figure]) -> int:
    """Print the table and what is missed, and return the exit status.

    Raises:
        ValueError: If no figure has a bound: such a benchmark could not fail.
    """
    if not any(one.verdict for one in figures):
        raise ValueError("no figure has a bound, so the benchmark could not fail")
    print(f"\n{table(figures)}", flush=True)
    misses = [one for one in figures if one.is_missed]
    for one in misses:
        print(f"missed: {one.what}: {one.value}, must be {one.bound}", file=sys.stderr)
    return MISSED if misses else HOLDS


def command_line(doc: str | None, usage: str = "") -> argparse.ArgumentParser:
    """Return a parser with a benchmark's text, examples of its use and the exit statuses.

    Args:
        doc: The benchmark's docstring.
        usage: Examples, a line each.
    """
    examples = "".join(f"  {line}\n" for line in usage.strip().splitlines())
    return argparse.ArgumentParser(
        description=doc,
        epilog=f"Examples:\n{examples}\n{STATUSES}" if examples else STATUSES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


@contextmanager
def refused(parser: argparse.ArgumentParser) -> Iterator[None]:
    """Tell what is wrong with a mission's settings, a log or a file, and end with status 2."""
    from executive.errors import ConfigError, DataError

    try:
        yield
    except (ConfigError, DataError) as error:
        parser.error(str(error))


def numbers(text: str) -> list[int]:
    """Read seeds or sites: `3`, or `1:10` for the first to the last.

    Raises:
        argparse.ArgumentTypeError: If the text is anything else.
    """
    try:
        first, _, last = text.partition(":")
        found = list(range(int(first), int(last or first) + 1))
    except ValueError:
        found = []
    if not found or found[0] < 0:
        raise argparse.ArgumentTypeError(
            f"{text!r} is no number and no range; write 3, or 1:10 for the first to the last"
        )
    return found


def add_seeds(parser: argparse.ArgumentParser, default: str = "1") -> None:
    """Let a benchmark take seeds, several of them or ranges; read them with `seeds_of`."""
    parser.add_argument(
        "seeds",
        type=numbers,
        nargs="*",
        default=[numbers(default)],
        metavar="SEED",
        help=f"seeds, such as 1 2 3 or 1:10 (default: {default})",
    )


def seeds_of(given: argparse.Namespace) -> list[int]:
    """Return the seeds of a command line in their order."""
    return [seed for some in given.seeds for seed in some]


def add_jobs(parser: argparse.ArgumentParser) -> None:
    """Let a benchmark use several processes; set OMP_NUM_THREADS=1 beside it."""
    parser.add_argument("--jobs", type=count, default=1, help="processes at a time (default: 1)")


def add_settings(parser: argparse.ArgumentParser) -> None:
    """Let a benchmark take settings of the mission, as `executive run --set` does."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        dest="settings",
        metavar="KEY=VALUE",
        help="a setting of the mission, as of `executive run --set`; may be given several times",
    )


def count(text: str) -> int:
    """Read a number of trials, one at least.

    Raises:
        argparse.ArgumentTypeError: If the text is anything else.
    """
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is no number of trials; write 1 or more")
    return int(text)
