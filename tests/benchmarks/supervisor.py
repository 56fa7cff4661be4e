"""Measure how soon a machine is told to stop when the executive's loop hangs or is killed.

Each trial lets a machine behind the wire swing its cabin, driven by a loop in a supervised process
that then fails in one way: `leaf` (it computes for ever), `read` (it waits for ever), `gil` (a
library holds the interpreter's lock), `kill` (kill -9). The time is from the failure to the call of
the machine's `safe_stop`. Every trial must be told within the bound. Five minutes for 100 trials.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/supervisor.py --trials 100
python tests/benchmarks/supervisor.py --trials 10 --kinds gil kill
"""
KINDS = ("leaf", "read", "gil", "kill")


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--trials", type=count, default=100, help="in all kinds together")
    parser.add_argument(
        "--kinds",
        nargs="+",
        choices=KINDS,
        default=KINDS,
        metavar="KIND",
        help=f"of {', '.join(KINDS)} (default: all)",
    )
    parser.add_argument("--silence", type=float, default=0.3, help="the machine's own limit [s]")
    parser.add_argument("--seed", type=int, default=1, help="of the moments of failure in a tick")
    given = parser.parse_args(words)

    from trials.supervisor import measured

    return verdict(measured(given.kinds, given.trials, given.silence, given.seed))


if __name__ == "__main__":
    sys.exit(main())
