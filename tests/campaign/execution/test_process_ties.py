"""What becomes of processes whose parent ends."""

import subprocess
import sys

ADOPTS = """
import os
from executive.campaign.execution.processes.process_ties import adopt_orphans

adopt_orphans()
reads, writes = os.pipe()
child = os.fork()
if not child:
    middle = os.getpid()
    if not os.fork():
        while os.getppid() == middle:
            pass
        os.write(writes, b"%d" % os.getppid())
    os._exit(0)
os.waitpid(child, 0)
assert int(os.read(reads, 20)) == os.getpid()
os.wait()
"""


def test_the_children_of_a_child_that_ended_become_those_of_a_process_that_adopts() -> None:
    subprocess.run([sys.executable, "-c", ADOPTS], check=True, timeout=60)
