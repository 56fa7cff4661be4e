"""Make the README's pictures: the simulated site from a camera, and a recording in the viewer.

    python docs/pictures.py site
    python docs/pictures.py recording RUN_DIR SECONDS

The second needs a Vulkan driver: a graphics card's, or the software one of Debian's
mesa-vulkan-drivers.
"""

import os
import sys
import time
from pathlib import Path

import numpy as np

IMAGES = Path(__file__).parent / "images"
SIZE = (1280, 720)


def site(seed: int = 1) -> Path:
    """Render the machine and its stones as they stand at the start of a run with this seed."""
    os.environ.setdefault("MUJOCO_GL", "egl")
    import mujoco
    from PIL import Image

    from executive.mission.assembly import assemble
    from executive.registry import settings_of
    from executive.tree.language import Selection

    robot = Selection("mujoco", settings_of("robot", "mujoco")())
    assembly = assemble({"robot": (robot,)}, "m545", seed)
    assembly.start()
    world = assembly.plugins["robot"].world
    camera = mujoco.MjvCamera()
    camera.lookat[:] = [3.0, 0.0, 1.0]
    camera.distance, camera.azimuth, camera.elevation = 15.0, 130.0, -24.0
    machine = {world.model.body(name).id for name in assembly.machine.links}
    for geom, body in enumerate(world.model.geom_bodyid):
        if body in machine:
            world.model.geom_rgba[geom] = [0.93, 0.66, 0.10, 1.0]
    world.model.vis.quality.shadowsize = 8192
    world.model.vis.global_.offwidth, world.model.vis.global_.offheight = SIZE
    renderer = mujoco.Renderer(world.model, height=SIZE[1], width=SIZE[0])
    renderer.update_scene(world.data, camera)
    path = IMAGES / "site.png"
    Image.fromarray(np.asarray(renderer.render())).save(path, optimize=True)
    renderer.close()
    assembly.close()
    return path


def recording(run_dir: str, seconds: float) -> Path:
    """Show a run's recording at a mission time in the viewer, without a screen, and save what it
    shows.
    """
    from rerun.experimental import ViewerClient

    path = IMAGES / "recording.png"
    viewer = ViewerClient.spawn(headless=True, port=9899, hide_welcome_screen=True)
    try:
        viewer.open(str(Path(run_dir) / "recording.rrd"))
        time.sleep(5)  # noqa: TID251 - the viewer tells nobody when it has loaded
        viewer.set_time("mission", duration=seconds, play_state="paused")
        time.sleep(5)  # noqa: TID251
        viewer.save_screenshot(str(path))
    finally:
        viewer.quit()
    return path


if __name__ == "__main__":
    IMAGES.mkdir(exist_ok=True)
    print(site() if sys.argv[1] == "site" else recording(sys.argv[2], float(sys.argv[3])))
