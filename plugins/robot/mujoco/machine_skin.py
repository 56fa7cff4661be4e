"""The machine's own surface, as its lidars see it."""

from executive_plugins.robot.mujoco.convex_mesh import hull_mesh
from executive_plugins.robot.mujoco.ray_mesh import Mesh, joined

from executive.machine.machine import Machine


def machine_skin(machine: Machine) -> dict[str, Mesh]:
    """Return one mesh a link, of all its convex shapes, in the link's frame; links without shapes
    are left out.
    """
    return {
        name: joined([hull_mesh(shape.vertices) for shape in link.shapes])
        for name, link in machine.links.items()
        if link.shapes
    }
