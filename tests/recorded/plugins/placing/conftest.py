"""The level sites of the tests of placing."""

import runpy
from pathlib import Path

_SHARED = runpy.run_path(str(Path(__file__).parents[3] / "plugins" / "placing" / "conftest.py"))
machine, planner_of, site = _SHARED["machine"], _SHARED["planner_of"], _SHARED["site"]
