"""Measure how long a pair of lidar revolutions takes in the simulator.

57,600 rays against ground, seven stones and the machine, on the wall clock. The figure belongs to
the computer: about 12 ms on an idle core. Ten seconds.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, verdict


def main(words: Sequence[str] | None = None) -> int:
    command_line(__doc__, "python tests/benchmarks/lidar_speed.py").parse_args(words)

    from trials.lidar_speed import measured

    return verdict(measured())


if __name__ == "__main__":
    sys.exit(main())
