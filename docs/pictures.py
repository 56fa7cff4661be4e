"""Make the README's pictures of a run: the simulated site, and its recording in the viewer.

    python docs/pictures.py site RUN_DIR
    python docs/pictures.py recording RUN_DIR SECONDS
    python docs/pictures.py hard_site

RUN_DIR is the folder of a run of `executive run pick_and_place --seed 3 --record`. The second
picture needs a Vulkan driver: that of a graphics card, or the software driver of Debian's
mesa-vulkan-drivers. The last one needs no run: a slope, obstacles, and the machine on its legs.
"""

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

IMAGES = Path(__file__).parent / "images"
SIZE = (1280, 720)
OVERSAMPLING = 2  # rendered larger and averaged, against jagged edges
MACHINE_RGBA = (0.93, 0.66, 0.10, 1.0)
SLOT_RGBA = (0.20, 0.55, 0.95, 0.65)
HARD_SEED = 8202
HARD_SITE: dict[str, Any] = {
    "scenario": "nominal",
    "base": "on_legs",
    "site": {
        "terrain": {"slope_rad": 0.12, "uphill_rad": 1.57, "pad_radius_m": 4},
        "stones": {"count": 4, "placement": {"sector_width_rad": 1.6}},
        "obstacles": [
            {"at_m": [9.5, 1], "size_m": [0.4, 8, 2]},
            {"shape": "cylinder", "at_m": [-2, 8], "size_m": [0.5, 0.5, 5]},
            {"at_m": [-7, -4], "size_m": [5, 2.4, 2.6], "yaw_rad": 0.6},
        ],
    },
}
SLOT_RADIUS_M, SLOT_HEIGHT_M = 0.55, 0.03


def site(run_dir: str) -> Path:
    """Render the machine, the stones and the slots as they are at the start of a run."""
    seed = json.loads((Path(run_dir) / "report.json").read_text(encoding="utf-8"))["seed"]
    view = {"lookat": [3.4, 0.0, 0.6], "distance": 13.5, "azimuth": 138.0, "elevation": -28.0}
    return _render(IMAGES / "site.png", {}, seed, view, _slots(run_dir))


def hard_site() -> Path:
    """Render the machine on its legs, on a terrace of a slope, between obstacles."""
    view = {"lookat": [1.5, 0.0, 1.0], "distance": 24.0, "azimuth": 118.0, "elevation": -24.0}
    return _render(IMAGES / "hard_site.png", HARD_SITE, HARD_SEED, view, [])


def _render(
    path: Path,
    settings: dict[str, Any],
    seed: int,
    view: dict[str, Any],
    slots: list[np.ndarray],
) -> Path:
    """Render the start of a mission on a simulated site from a viewpoint."""
    os.environ.setdefault("MUJOCO_GL", "egl")
    import mujoco
    from PIL import Image

    from executive.mission.assembly import assemble
    from executive.registry import settings_of
    from executive.tree.selection import Selection

    robot = Selection("mujoco", settings_of("robot", "mujoco").model_validate(settings))
    assembly = assemble({"robot": (robot,)}, "m545", seed)
    assembly.start()
    world = assembly.plugins["robot"].world
    _paint(world.model, [world.model.body(name).id for name in assembly.machine.links])
    size = [OVERSAMPLING * pixels for pixels in SIZE]
    world.model.vis.global_.offwidth, world.model.vis.global_.offheight = size
    camera = mujoco.MjvCamera()
    camera.lookat[:] = view["lookat"]
    camera.distance, camera.azimuth = view["distance"], view["azimuth"]
    camera.elevation = view["elevation"]
    renderer = mujoco.Renderer(world.model, height=size[1], width=size[0])
    renderer.update_scene(world.data, camera)
    for position in slots:
        _add_disc(renderer.scene, position)
    Image.fromarray(np.asarray(renderer.render())).resize(SIZE, Image.Resampling.BOX).save(
        path, optimize=True
    )
    renderer.close()
    assembly.close()
    return path


def _paint(model: Any, machine: list[int]) -> None:
    """Colour the machine, and choose a shadow map that leaves no specks on the rough ground.

    A surface that is nearly parallel to the light falls into its own shadow where a texel of the
    map is wide. Smaller texels and twice the depth range removed all specks.
    """
    for geom, body in enumerate(model.geom_bodyid):
        if body in machine:
            model.geom_rgba[geom] = MACHINE_RGBA
    model.vis.quality.shadowsize = 16384
    model.vis.map.shadowclip = 2.0


def _slots(run_dir: str) -> list[np.ndarray]:
    """Return the positions of the slots that a run found, in the map [m]."""
    for line in (Path(run_dir) / "journal.jsonl").read_text(encoding="utf-8").splitlines():
        entry = json.loads(line)
        if entry["kind"] == "slots_found":
            return [np.array(slot["position_map"]) for slot in entry["payload"]["slots"]]
    sys.exit(f"{run_dir}: the journal has no `slots_found` event")


def _add_disc(scene: Any, position: np.ndarray) -> None:
    """Add a disc to the scene: a mark without mass or contact."""
    import mujoco

    mujoco.mjv_initGeom(
        scene.geoms[scene.ngeom],
        mujoco.mjtGeom.mjGEOM_CYLINDER,
        np.array([SLOT_RADIUS_M, SLOT_HEIGHT_M, 0.0]),
        position,
        np.eye(3).ravel(),
        np.array(SLOT_RGBA, dtype=np.float32),
    )
    scene.ngeom += 1


def recording(run_dir: str, seconds: float) -> Path:
    """Show a run's recording at a mission time in the viewer, without a screen, and save what it
    shows.
    """
    from PIL import Image
    from rerun.experimental import ViewerClient

    path = IMAGES / "recording.png"
    viewer = ViewerClient.spawn(headless=True, port=9899, hide_welcome_screen=True)
    try:
        viewer.open(str(Path(run_dir) / "recording.rrd"))
        time.sleep(30)  # noqa: TID251 - the viewer does not report when it has loaded
        viewer.set_time("mission", duration=seconds, play_state="paused")
        time.sleep(30)  # noqa: TID251
        viewer.save_screenshot(str(path))
    finally:
        viewer.quit()
    Image.open(path).convert("RGB").resize(SIZE, Image.Resampling.LANCZOS).save(path, optimize=True)
    return path


if __name__ == "__main__":
    IMAGES.mkdir(exist_ok=True)
    match sys.argv[1:]:
        case ["site", run_dir]:
            print(site(run_dir))
        case ["hard_site"]:
            print(hard_site())
        case ["recording", run_dir, seconds]:
            print(recording(run_dir, float(seconds)))
        case _:
            sys.exit(__doc__)
