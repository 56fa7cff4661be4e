"""Make the README's film: the simulated machine moves one stone, as an animated picture.

    python docs/film.py [SEED]

A mission of three stones runs until the first one is placed and looked at again. Its states are
drawn at the true poses, with the slots that it found. The README shows seed 12511. Two minutes of
processor time.
"""

import os
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from pictures import IMAGES, _add_disc, _paint

SIZE = (640, 360)
OVERSAMPLING = 2  # rendered larger and averaged, against jagged edges
EVERY_S = 0.4  # of the mission's time, between two frames
FRAME_MS = 80  # five times as fast as the machine
QUALITY = 60  # of WebP
SETTINGS = ("robot.scenario=nominal", "robot.site.stones.count=3")


@dataclass(eq=False)
class Take:
    """What a mission has shown: the slots [m], and its states from the first attempt on."""

    slots: list[np.ndarray] = field(default_factory=list)
    states: list[np.ndarray] = field(default_factory=list)
    began_s: float = np.inf
    is_over: bool = False

    def see(self, entry: Any) -> None:
        """Take an entry of the journal."""
        if entry.kind == "slots_found":
            self.slots = [np.array(s["position_map"]) for s in entry.event.payload()["slots"]]
        elif entry.kind == "attempt_started":
            self.began_s = min(self.began_s, entry.time_s)
        elif entry.kind == "placement_verified":
            self.is_over = True

    def watch(self, mission: Any, world: Any) -> None:
        """Keep the state if a frame is due, and stop the mission once its stone is placed."""
        if mission.clock.now_s() >= self.began_s + EVERY_S * len(self.states) - 1e-9:
            self.states.append(world.data.qpos.copy())
        if self.is_over:
            mission.request_stop()


def shoot(seed: int) -> tuple[Take, Any, tuple[str, ...]]:
    """Run the mission; return what it showed, its model, and the names of the machine's links."""
    from executive.mission.options import Options
    from executive.mission.run import Run
    from executive.tree.load import load_mission

    take = Take()
    with tempfile.TemporaryDirectory() as folder:
        options = Options(run_dir=Path(folder) / "run", seed=seed)
        run = Run(load_mission("pick_and_place", SETTINGS), options)
        run._journal.follow(take.see)
        robot = run._assembly.plugins["robot"]
        kept: list[Any] = []

        def after_tick(mission: Any) -> None:
            kept[:] = [robot.world.model]
            take.watch(mission, robot.world)

        run.execute(after_tick)
    return take, kept[0], tuple(run._assembly.machine.links)


def draw(take: Take, model: Any, links: tuple[str, ...]) -> Path:
    """Render the states, and write them as an animated picture."""
    import mujoco
    from PIL import Image

    _paint(model, [model.body(name).id for name in links])
    model.vis.quality.shadowsize = 4096
    width, height = (OVERSAMPLING * pixels for pixels in SIZE)
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    camera = mujoco.MjvCamera()
    camera.lookat[:] = [2.8, 0.0, 1.2]
    camera.distance, camera.azimuth, camera.elevation = 12.5, 138.0, -26.0
    data, frames = mujoco.MjData(model), []
    with mujoco.Renderer(model, height=height, width=width) as renderer:
        for qpos in take.states:
            data.qpos[:] = qpos
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, camera)
            for position in take.slots:
                _add_disc(renderer.scene, position)
            picture = Image.fromarray(np.asarray(renderer.render()))
            frames.append(picture.resize(SIZE, Image.Resampling.BOX))
    path = IMAGES / "cycle.webp"
    rest = {"append_images": frames[1:], "duration": FRAME_MS, "loop": 0}
    frames[0].save(path, save_all=True, quality=QUALITY, method=4, minimize_size=True, **rest)
    return path


if __name__ == "__main__":
    os.environ.setdefault("MUJOCO_GL", "egl")
    path = draw(*shoot(int(sys.argv[1]) if sys.argv[1:] else 3))
    print(f"{path}: {path.stat().st_size / 1e6:.2f} MB")
