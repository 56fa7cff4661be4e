"""A stone whose whole surface and mass are known: what structures are planned with."""

from dataclasses import dataclass, field

import numpy as np

from executive.arrays import Float, Int, checked
from executive.errors import DataError
from executive.geometry.solid import inertia_about_origin, is_closed, volume_and_centroid

_NO_VOLUME = "its surface encloses no volume"


@dataclass(frozen=True, slots=True, eq=False)
class SolidStone:
    """A closed surface in the stone's frame, whose origin is its believed centre of mass.

    Attributes:
        name: What people call it, such as the name of its file without the suffix.
        vertices: Vertices of the surface [m], shape (V, 3).
        triangles: Corners of its triangles, counter-clockwise from outside, shape (F, 3).
        mass_kg: Mass [kg].
        doubt_m: How far the true surface may be from this one, one standard deviation [m].
        jaws: Points on the jaws that let the stone go, in its frame, one array (N, 3) [m] a grasp.
            At its place there has to be room for those of one grasp; without any it is set down by
            nothing.
        volume_m3: Volume within the surface [m³].
        extents_m: Lengths along the principal axes of the surface, longest first, (3,) [m].
    """

    name: str
    vertices: Float
    triangles: Int
    mass_kg: float
    doubt_m: float = 0.0
    jaws: tuple[Float, ...] = ()
    volume_m3: float = field(init=False)
    extents_m: Float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", checked("vertices", self.vertices, None, 3))
        object.__setattr__(
            self, "triangles", checked("triangles", self.triangles, None, 3, dtype=np.int64)
        )
        jaws = tuple(checked("jaws", points, None, 3) for points in self.jaws)
        object.__setattr__(self, "jaws", jaws)
        if not len(self.triangles) or not is_closed(self.triangles):
            raise DataError(
                f"stone '{self.name}': its surface is not closed, so it has no volume; "
                "fill the holes of the mesh, or take its convex hull"
            )
        volume_m3 = volume_and_centroid(self.vertices, self.triangles)[0]
        object.__setattr__(self, "volume_m3", volume_m3)
        if not volume_m3 > 0 or not np.isfinite(self.mass_kg) or self.mass_kg <= 0:
            raise DataError(f"stone '{self.name}': {_NO_VOLUME}, or it has no mass")
        object.__setattr__(self, "extents_m", checked("extents", _extents_m(self.vertices), 3))

    @classmethod
    def of_mesh(
        cls, name: str, vertices: Float, triangles: Int, density_kg_m3: float
    ) -> "SolidStone":
        """Return a homogeneous stone; its origin moves to the centroid of its volume.

        Raises:
            DataError: If the mesh is not closed, or encloses no volume.
        """
        volume_m3, centroid = volume_and_centroid(vertices, triangles)
        if not np.isfinite(centroid).all():
            raise DataError(f"stone '{name}': {_NO_VOLUME}")
        facing = triangles if volume_m3 > 0 else triangles[:, ::-1]
        return cls(name, vertices - centroid, facing, abs(volume_m3) * density_kg_m3)

    def inertia(self) -> Float:
        """Return the inertia about the origin as of an even density [kg·m²], shape (3, 3)."""
        density = self.mass_kg / self.volume_m3
        return inertia_about_origin(self.vertices, self.triangles, density)


def _extents_m(vertices: Float) -> Float:
    centred = vertices - vertices.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    return np.asarray(np.sort(np.ptp(centred @ axes.T, axis=0))[::-1])
