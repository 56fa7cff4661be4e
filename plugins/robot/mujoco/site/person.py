"""Somebody who walks on a site: along a line and back, whatever the machine does."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh
from executive_plugins.robot.mujoco.site.settings import PersonSettings
from executive_plugins.robot.mujoco.site.terrain import Terrain

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh

_SIDES = 12  # corners of the outline for rays: at most 1 cm inside its circle
PERSON = "person_"  # begins the names of their bodies


@dataclass(frozen=True, slots=True, eq=False)
class Person:
    """An upright cylinder that walks, and that nothing presses.

    A body whose place is given would push the machine over, and a person does not: it is no part of
    MuJoCo's contacts, and `truth/contact_log.py` finds what touches it.

    Attributes:
        name: Its body in MuJoCo, and its name in the report.
        path_world: Corners of the line that it walks, on the ground [m], shape (N, 3).
        speed_m_s: Its speed, as seen from above [m/s].
        radius_m: Half of its width [m].
        height_m: Its height [m].
    """

    name: str
    path_world: Float
    speed_m_s: float
    radius_m: float
    height_m: float

    def at(self, time_s: float) -> Float:
        """Return the place of its feet at a time [m], shape (3,).

        It walks to the end of the line, turns round, and so on.
        """
        steps = np.linalg.norm(np.diff(self.path_world[:, :2], axis=0), axis=1)
        passed = np.concatenate([[0.0], np.cumsum(steps)])
        gone = (self.speed_m_s * time_s) % (2 * passed[-1])
        along = min(gone, 2 * passed[-1] - gone)
        return np.array([np.interp(along, passed, axis) for axis in self.path_world.T])

    def mesh(self) -> Mesh:
        """Return its surface in the frame of its body, whose origin is at its feet."""
        angles = np.arange(_SIDES) * 2 * np.pi / _SIDES
        ring = self.radius_m * np.c_[np.cos(angles), np.sin(angles)]
        return hull_mesh(np.vstack([np.c_[ring, np.full(_SIDES, z)] for z in (0.0, self.height_m)]))

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add it to a world, as a body that is moved and moves nothing."""
        body = spec.worldbody.add_body(name=self.name, pos=self.at(0.0).tolist(), mocap=True)
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[self.radius_m, self.height_m / 2, 0.0],
            pos=[0.0, 0.0, self.height_m / 2],
            contype=0,
            conaffinity=0,
            rgba=[0.9, 0.5, 0.1, 1.0],
        )


def make_people(settings: Sequence[PersonSettings], terrain: Terrain) -> tuple[Person, ...]:
    """Put the people on the ground at the corners of their lines, `person_1` first."""
    people = []
    for number, one in enumerate(settings, 1):
        corners = np.array(one.path_m)
        path_world = np.column_stack([corners, terrain.height_at(corners)])
        people.append(
            Person(f"{PERSON}{number}", path_world, one.speed_m_s, one.width_m / 2, one.height_m)
        )
    return tuple(people)


class Walk:
    """Moves the people of a world; their places follow from the time alone."""

    def __init__(self, people: Sequence[Person], model: mujoco.MjModel) -> None:
        self._people = tuple(people)
        self._slots = [int(model.body_mocapid[model.body(one.name).id]) for one in self._people]

    def step(self, time_s: float, data: mujoco.MjData) -> None:
        """Put all where they are at a time [s]."""
        for slot, person in zip(self._slots, self._people, strict=True):
            data.mocap_pos[slot] = person.at(time_s)
