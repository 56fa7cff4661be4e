"""Standard output on a full disk, and standard files that are closed: messages, and whole runs."""

import os
import subprocess
import sys

EXECUTIVE = [sys.executable, "-m", "executive.commands.entry"]


def test_an_answer_that_does_not_fit_on_the_disk_is_an_error() -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        ended = subprocess.run(
            [*EXECUTIVE, "--version"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=120
        )
    assert ended.returncode == 2
    assert ended.stderr == "error: No space left on device\n"


def test_closed_standard_files_do_not_lend_their_numbers() -> None:
    program = (
        "import os; [os.close(n) for n in range(3)]\n"
        "from executive.commands.entry import _open_standard_files; _open_standard_files()\n"
        "print('nobody reads this'); found = os.open('/dev/null', os.O_RDONLY)\n"
        "os._exit(0 if found == 3 else found + 10)"
    )
    assert (
        subprocess.run([sys.executable, "-c", program], timeout=120, env=os.environ).returncode == 0
    )
