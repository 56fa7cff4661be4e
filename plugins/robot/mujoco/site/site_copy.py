"""A site as it was at one moment, for a survey that is computed while the world goes on."""

from collections.abc import Iterator, Sequence

import numpy as np
from executive_plugins.robot.mujoco.site.photographs import photograph_site
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.site_scene import SiteScene
from numpy.typing import NDArray

from executive.arrays import Float
from executive.interfaces.facilities import Photographer, Scene


class SiteCopy(Scene, Photographer):
    """Ground, obstacles and stones that stay where they are; it shares nothing that changes."""

    def __init__(self, site: Site, T_world_stones: Sequence[Float]) -> None:
        """Take the poses of the stones, (4, 4) each."""
        self._site, self._T_world_stones = site, tuple(T.copy() for T in T_world_stones)
        self._scene: SiteScene | None = None

    def cast_rays(self, origins_world: Float, directions_world: Float) -> Float:
        if self._scene is None:
            self._scene = SiteScene(self._site)
            for _ in range(2):  # a stone rests once it has not moved since the last call
                self._scene.update(self._T_world_stones)
        return self._scene.cast_rays(origins_world, directions_world)

    def photograph(
        self, T_world_opticals: Sequence[Float], size_px: tuple[int, int], view_angle_rad: float
    ) -> Iterator[NDArray[np.uint8]]:
        return photograph_site(
            self._site, self._T_world_stones, T_world_opticals, size_px, view_angle_rad
        )
