"""Measure what a tick of a tree costs, beside the same tree of bare py_trees nodes.

Three trees of 500 leaves: a reactive sequence that asks 500 conditions and then goes on with an
action; a parallel with 500 running actions; and a sequence whose 500 actions all succeed in one
tick. Leaves do nothing, and events are not written. Given is the processor's time, the best of
several batches, so that other work on the machine counts little. Five seconds.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/ticks.py
python tests/benchmarks/ticks.py --batches 30
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--batches", type=count, default=15, help="of ticks (default: 15)")
    parser.add_argument("--ticks", type=count, default=40, help="of a batch (default: 40)")
    given = parser.parse_args(words)

    from trials.ticks import measured

    return verdict(measured(given.batches, given.ticks))


if __name__ == "__main__":
    sys.exit(main())
