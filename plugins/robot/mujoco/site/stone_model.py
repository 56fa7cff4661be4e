"""A stone of the simulated world: its contact hull, its visible surface, and its mass."""

from dataclasses import dataclass

import mujoco
import numpy as np

from executive.arrays import Float, Int, checked
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.solid import (
    inertia_about_origin,
    volume_and_centroid,
)

SEEN_GROUP = 2  # geometry group that MuJoCo draws by default
TOUCHED_GROUP = 3  # geometry group that is hidden by default


@dataclass(frozen=True, slots=True, eq=False)
class StoneModel:
    """A solid with its frame at its centroid.

    Attributes:
        name: Name of its body, such as `stone_1`.
        hull: Corners of the convex hull, the contact geometry [m], shape (H, 3).
        vertices: Vertices of the skin, the surface that lidars see [m], shape (V, 3).
        triangles: Triangles of the skin, counter-clockwise from outside, shape (F, 3).
        volume_m3: Volume enclosed by the skin.
        mass_kg: Mass of the skin's volume, not of the hull's.
        inertia: Inertia about the centroid, in the axes of the stone [kg·m²], shape (3, 3).
    """

    name: str
    hull: Float
    vertices: Float
    triangles: Int
    volume_m3: float
    mass_kg: float
    inertia: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "hull", checked("hull", self.hull, None, 3))
        object.__setattr__(self, "vertices", checked("vertices", self.vertices, None, 3))
        object.__setattr__(
            self, "triangles", checked("triangles", self.triangles, None, 3, dtype=np.int64)
        )
        object.__setattr__(self, "inertia", checked("inertia", self.inertia, 3, 3))

    @classmethod
    def from_skin(
        cls, name: str, skin: tuple[Float, Int], density_kg_m3: float, hull: Float | None = None
    ) -> "StoneModel":
        """Build a stone from a closed mesh; the origin moves to the centroid of the volume.

        Args:
            name: Name of its body.
            skin: Vertices [m] and triangles, counter-clockwise from outside.
            density_kg_m3: Density.
            hull: Corners of the contact geometry; the convex hull of the skin if not given.
        """
        vertices, triangles = skin
        volume_m3, centroid = volume_and_centroid(vertices, triangles)
        about = vertices - centroid
        inertia = inertia_about_origin(about, triangles, density_kg_m3)
        touching = hull_mesh(about)[0] if hull is None else hull - centroid
        return cls(name, touching, about, triangles, volume_m3, volume_m3 * density_kg_m3, inertia)

    def add_to(self, spec: mujoco.MjSpec, T_world_stone: Float) -> None:
        """Add the stone to a world as a free body.

        The contact geometry is the convex hull, also of a scanned stone: its hollows are solid for
        the jaws (the hull of a typical scan has 14 % more volume). Mass, inertia and lidars use the
        skin.
        """
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, np.ascontiguousarray(T_world_stone[:3, :3]).ravel())
        body = spec.worldbody.add_body(
            name=self.name, pos=T_world_stone[:3, 3].tolist(), quat=quat.tolist()
        )
        body.add_freejoint(name=self.name)
        moments = self.inertia
        body.explicitinertial = True
        body.mass = self.mass_kg
        body.ipos = [0.0, 0.0, 0.0]  # the default would be the position of the body in the world
        body.fullinertia = [*np.diag(moments), moments[0, 1], moments[0, 2], moments[1, 2]]
        hull, seen = f"{self.name}_hull", f"{self.name}_skin"
        spec.add_mesh(
            name=hull,
            uservert=self.hull.ravel(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        )
        spec.add_mesh(
            name=seen,
            uservert=self.vertices.ravel(),
            userface=self.triangles.ravel().astype(np.int32),
        )
        mesh = mujoco.mjtGeom.mjGEOM_MESH
        body.add_geom(name=hull, type=mesh, meshname=hull, mass=0.0, group=TOUCHED_GROUP)
        body.add_geom(
            name=seen,
            type=mesh,
            meshname=seen,
            mass=0.0,
            group=SEEN_GROUP,
            contype=0,
            conaffinity=0,
            rgba=[0.62, 0.62, 0.6, 1.0],
        )
