"""What `start` promises, in processes of their own: nothing is compiled later, and threads change
no bit.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

PROGRAM = """
import json, sys
import numpy as np
from executive.messages.cloud import Cloud
from executive_plugins.alignment.gicp import Gicp, GicpSettings
from executive_plugins.registration.segment_shot import SegmentShot, SegmentShotSettings
from executive_plugins.segmentation.ground_and_clusters import (
    GroundAndClusters,
    GroundAndClustersSettings,
)

def compiled():
    ours = [module for name, module in sys.modules.items() if name.startswith("executive_plugins.")]
    loops = [
        (name, loop)
        for module in ours
        for name, loop in vars(module).items()
        if hasattr(loop, "signatures")
    ]
    return {name: len(loop.signatures) for name, loop in loops}

segmentation = GroundAndClusters(GroundAndClustersSettings())
alignment = Gicp(GicpSettings())
registrar = SegmentShot(SegmentShotSettings(), segmentation, alignment)
for plugin in (segmentation, alignment, registrar):
    plugin.start()
before = compiled()
clouds = np.load(sys.argv[1])
target, source = Cloud("map", clouds["target"]), Cloud("survey", clouds["source"])
found = registrar.register(target, source, np.random.default_rng(0))
late = [name for name, count in compiled().items() if count > before.get(name, 0)]
print(json.dumps({"late": late, "loops": len(before), "T": found.T_target_source.tobytes().hex(),
                  "accepted": found.accepted, "scale": found.scale.hex()}))
"""


def register_with(threads: int, clouds: Path) -> dict:
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
    environment = {**os.environ, **dict.fromkeys(names, str(threads))}
    command = [sys.executable, "-c", PROGRAM, str(clouds)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def answers(make_scene: Callable, tmp_path_factory: pytest.TempPathFactory) -> list[dict]:
    scene = make_scene(102, rays=120_000)
    clouds = tmp_path_factory.mktemp("clouds") / "scene.npz"
    np.savez(clouds, target=scene.target.points, source=scene.source.points)
    return [register_with(threads, clouds) for threads in (1, 4)]


def test_nothing_is_compiled_after_start(answers: list[dict]) -> None:
    assert answers[0]["accepted"]
    assert answers[0]["loops"] > 10
    assert answers[0]["late"] == []


def test_the_number_of_threads_changes_no_bit(answers: list[dict]) -> None:
    assert answers[0]["T"] == answers[1]["T"]
    assert answers[0]["scale"] == answers[1]["scale"]
