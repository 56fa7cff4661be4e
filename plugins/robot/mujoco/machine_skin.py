"""The machine's own surface, as its lidars see it."""

from collections.abc import Mapping

from executive.arrays import Float
from executive.geometry.pose import inverse
from plugins.robot.mujoco.convex_mesh import hull_mesh
from plugins.robot.mujoco.ray_mesh import Mesh, joined, moved
from robot_models.link import Link
from robot_models.machine import Machine


class MachineSkin:
    """All links' convex shapes, in their links' frames."""

    def __init__(self, machine: Machine) -> None:
        self._links = {name: _mesh(link) for name, link in machine.links.items() if link.shapes}

    def mesh(self, link: str) -> tuple[Mesh, ...]:
        """Return one link in its own frame; none if it has no shapes."""
        return (self._links[link],) if link in self._links else ()

    def others(self, link: str, T_world: Mapping[str, Float], T_world_frame: Float) -> list[Mesh]:
        """Return all links but one, expressed in a frame."""
        T_frame_world = inverse(T_world_frame)
        return [moved(mesh, T_frame_world @ T_world[name]) for name, mesh in self._links.items() if name != link]


def _mesh(link: Link) -> Mesh:
    return joined([hull_mesh(shape.vertices) for shape in link.shapes])
