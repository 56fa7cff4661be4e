"""The site of the tests of motion."""

import runpy
from pathlib import Path

_SHARED = runpy.run_path(str(Path(__file__).parents[3] / "plugins" / "motion" / "conftest.py"))
make_site, make_planner = _SHARED["make_site"], _SHARED["make_planner"]
