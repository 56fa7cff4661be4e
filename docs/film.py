"""Make the films of the README and of `walls.md`: what the simulated machine does, as an animated
picture.

    python docs/film.py cycle [SEED]
    python docs/film.py wall [SEED]

`cycle` is a mission of three stones until the first one is placed and looked at again, with the
slots that it found; the README shows seed 12601. `wall` is `build_wall` until its structure is
ended; `walls.md` shows seed 15113. The states are drawn at the true poses. Two minutes of processor
time, and ten.
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
FRAME_MS = 80
QUALITY = 60  # of WebP


@dataclass(frozen=True)
class Film:
    """A mission, and what is to be seen of it.

    Attributes:
        mission: Its name.
        settings: What it is run with.
        every_s: Of the mission's time, between two frames.
        ends_with: Kind of the event that ends it.
        shows_slots: Whether the slots are drawn.
        lookat: What the camera looks at [m].
        view: Its distance [m], azimuth and elevation [deg].
    """

    mission: str
    settings: tuple[str, ...]
    every_s: float
    ends_with: str
    shows_slots: bool
    lookat: tuple[float, float, float]
    view: tuple[float, float, float]


FILMS = {
    "cycle": Film(  # five times as fast as the machine
        "pick_and_place", ("robot.scenario=nominal", "robot.site.stones.count=3"), 0.4,
        "placement_verified", True, (2.8, 0.0, 1.2), (12.5, 138.0, -26.0),
    ),
    "wall": Film(  # 25 times as fast
        "build_wall", (), 2.0, "building_ended", False, (-1.8, 0.0, 0.8), (12.5, 40.0, -26.0),
    ),
}  # fmt: skip


@dataclass(eq=False)
class Take:
    """What a mission has shown: the slots [m], and its states from the first attempt on."""

    film: Film
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
        elif entry.kind == self.film.ends_with:
            self.is_over = True

    def watch(self, mission: Any, world: Any) -> None:
        """Keep the state if a frame is due, and stop the mission once it is over."""
        if mission.clock.now_s() >= self.began_s + self.film.every_s * len(self.states) - 1e-9:
            self.states.append(world.data.qpos.copy())
        if self.is_over:
            mission.request_stop()


def shoot(film: Film, seed: int) -> tuple[Take, Any, tuple[str, ...]]:
    """Run the mission; return what it showed, its model, and the names of the machine's links."""
    from executive.mission.options import Options
    from executive.mission.run import Run
    from executive.tree.load import load_mission

    take = Take(film)
    with tempfile.TemporaryDirectory() as folder:
        options = Options(run_dir=Path(folder) / "run", seed=seed)
        run = Run(load_mission(film.mission, film.settings), options)
        run._journal.follow(take.see)
        robot = run._assembly.plugins["robot"]
        kept: list[Any] = []

        def after_tick(mission: Any) -> None:
            kept[:] = [robot.world.model]
            take.watch(mission, robot.world)

        run.execute(after_tick)
    return take, kept[0], tuple(run._assembly.machine.links)


def draw(path: Path, take: Take, model: Any, links: tuple[str, ...]) -> None:
    """Render the states, and write them as an animated picture."""
    import mujoco
    from PIL import Image

    _paint(model, [model.body(name).id for name in links])
    model.vis.quality.shadowsize = 4096
    width, height = (OVERSAMPLING * pixels for pixels in SIZE)
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    camera = mujoco.MjvCamera()
    camera.lookat[:] = take.film.lookat
    camera.distance, camera.azimuth, camera.elevation = take.film.view
    data, frames = mujoco.MjData(model), []
    with mujoco.Renderer(model, height=height, width=width) as renderer:
        for qpos in take.states:
            data.qpos[:] = qpos
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, camera)
            for position in take.slots if take.film.shows_slots else ():
                _add_disc(renderer.scene, position)
            picture = Image.fromarray(np.asarray(renderer.render()))
            frames.append(picture.resize(SIZE, Image.Resampling.BOX))
    rest = {"append_images": frames[1:], "duration": FRAME_MS, "loop": 0}
    frames[0].save(path, save_all=True, quality=QUALITY, method=4, minimize_size=True, **rest)


if __name__ == "__main__":
    os.environ.setdefault("MUJOCO_GL", "egl")
    name, seed = sys.argv[1], int(sys.argv[2]) if sys.argv[2:] else 3
    path = IMAGES / f"{name}.webp"
    draw(path, *shoot(FILMS[name], seed))
    print(f"{path}: {path.stat().st_size / 1e6:.2f} MB")
