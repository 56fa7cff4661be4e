"""Measure what a campaign costs over a cluster, and what a second worker gives.

A scheduler and workers of dask.distributed are started on this computer, on the loopback address
alone. Two workers keep two processors busy, so that the computer has to be idle; its load is
printed. Beside the speed stand what the model in docs/how-to/clusters.md is made of: processor time
of scheduler and campaign for a run, sizes of messages, speed of inputs and of the ledger.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = "OMP_NUM_THREADS=1 python tests/benchmarks/campaign_cluster.py --runs 20"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument(
        "--runs", type=count, default=20, help="runs of half a second in each part (default: 20)"
    )
    given = parser.parse_args(words)

    from trials.campaign_cluster import measured

    return verdict(measured(given.runs))


if __name__ == "__main__":
    sys.exit(main())
