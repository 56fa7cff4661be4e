"""The yard of the tests of odometry."""

import runpy
from pathlib import Path

_SHARED = runpy.run_path(str(Path(__file__).parents[3] / "plugins" / "odometry" / "conftest.py"))
yard = _SHARED["yard"]
