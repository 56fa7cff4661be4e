"""Let plugins fail in every way, in every capability with jobs and in every runner.

A cell is one call of a verb that fails in one way, in a supervised process as `executive run` has
it. It passes if the call is answered after all by a new worker, or ends with status 3 and a report
that names plugin, verb, file and line; each within 2 s beyond the verb's limit. `once` faults are
those of which a new worker is cured; they are tried where there are workers. Twenty minutes.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, verdict

USAGE = """
python tests/benchmarks/plugin_cells.py
python tests/benchmarks/plugin_cells.py --capabilities motion grasping --faults hang segfault
"""
CAPABILITIES = (
    "segmentation",
    "surveying",
    "alignment",
    "registration",
    "motion",
    "grasping",
    "placing",
)
FAULTS = (
    "raise",
    "wrong_type",
    "nan",
    "late",
    "hang",
    "hold_gil",
    "sigkill",
    "segfault",
    "os_exit",
    "sys_exit",
    "unpicklable_argument",
    "unpicklable_answer",
    "leak",
    "start",
)


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    for name, choices in (("capabilities", CAPABILITIES), ("faults", FAULTS)):
        parser.add_argument(
            f"--{name}",
            nargs="+",
            choices=choices,
            default=choices,
            metavar="NAME",
            help=f"of {', '.join(choices)} (default: all)",
        )
    given = parser.parse_args(words)

    from trials.plugin_cells import measured

    return verdict(measured(given.faults, given.capabilities))


if __name__ == "__main__":
    sys.exit(main())
