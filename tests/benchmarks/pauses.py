"""Pause a mission without physics at random ticks: does it go on as if nothing had been?

Each run is paused once, at a random tick, for 5 s to 10 min of machine time, and compared with one
that is not. A run is broken if it ends otherwise, or if its journal differs in more than the
pause. With `--held` the machine's time stands still once the machine is at rest, as it does in
lock-step; without it the machine's time goes on, as on a real machine. Ten minutes for 200 pauses.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/pauses.py --pauses 200 --held
python tests/benchmarks/pauses.py --pauses 20
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--pauses", type=count, default=200, help="runs, one pause in each")
    parser.add_argument("--seed", type=int, default=1, help="of the ticks and lengths (default: 1)")
    parser.add_argument(
        "--held", action="store_true", help="the machine's time stands still while it is at rest"
    )
    given = parser.parse_args(words)

    from trials.pauses import measured

    return verdict(measured(given.pauses, given.seed, given.held))


if __name__ == "__main__":
    sys.exit(main())
