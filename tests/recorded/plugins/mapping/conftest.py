"""The yard of the tests of mapping, seen by a swinging machine."""

import runpy
from pathlib import Path

_SHARED = runpy.run_path(str(Path(__file__).parents[3] / "plugins" / "mapping" / "conftest.py"))
machine, make_yard = _SHARED["machine"], _SHARED["make_yard"]
