"""The program `executive`: the command line, and runs under a supervisor of their own.

This file imports nothing heavy: the supervisor is forked from it before the executive is imported.
"""

import os
import sys

from executive.supervision.early_stop import end_at_signals, take_defaults

_SUPERVISED = ("run", "resume")


def main() -> None:
    """Run the command line; a verb that moves a machine is supervised."""
    end_at_signals()
    _open_standard_files()
    words = sys.argv[1:]
    is_still = {"--help", "--dry"} & set(words)  # no machine moves
    if words and words[0] in _SUPERVISED and not is_still:
        from executive.supervision.supervisor import supervised

        # A mission computes in one loop. More threads of the linear algebra library would spin
        # between its calls; a campaign's runs have one, too.
        os.environ.setdefault("OMP_NUM_THREADS", "1")
        sys.exit(supervised(_status, lambda text: print(text, file=sys.stderr, flush=True)))
    sys.exit(_status_of_a_tool())


def _status_of_a_tool() -> int:
    """Run a verb that moves no machine; Ctrl-C ends it, as it ends any program."""
    take_defaults()
    try:
        return _status()
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 1


def _open_standard_files() -> None:
    """Open /dev/null for each standard file that is closed, as in `executive run m.yaml >&-`.

    Their numbers would otherwise go to the next files that are opened, such as a pipe of the
    supervisor.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            found = os.open(os.devnull, os.O_RDWR)  # the lowest free number: this one
            setattr(sys, name, os.fdopen(found, "w" if number else "r", encoding="utf-8"))


def _status() -> int:
    from executive.commands.main import main as command_line

    try:
        command_line()
    except SystemExit as end:
        code = end.code
        if isinstance(code, str):
            print(code, file=sys.stderr)
        return code if isinstance(code, int) else int(code is not None)
    return 0


if __name__ == "__main__":
    main()
