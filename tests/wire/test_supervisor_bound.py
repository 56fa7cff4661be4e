"""The machine is told to stop in time, however the executive fails: one trial of each kind.

`python tests/benchmarks/supervisor.py` does a hundred.
"""

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
BOUND_S = 0.3
BUSY_S = 0.5  # beyond the bound: tests share the processors with others


@pytest.mark.parametrize("kind", ["leaf", "read", "gil", "kill"])
def test_the_machine_is_told_to_stop(kind):
    code = (
        f"import sys; sys.path.insert(0, {str(BENCHMARKS)!r});"
        "from trials.supervisor import trial;"
        f"print(*trial({kind!r}, 0.01, 5.0))"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=True
    )
    seconds, who = ended.stdout.split()
    assert float(seconds) < BOUND_S + BUSY_S
    assert kind == "kill" or who == "supervisor"  # of a dead executive both learn at once
