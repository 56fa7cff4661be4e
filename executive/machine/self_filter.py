"""Classification of lidar returns from the machine itself (Mascaro 2020, Sec. 4.2, step 1)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.spatial import ConvexHull

from executive.arrays import Bool, Float, Int, read_only
from executive.geometry.pose import inverse
from executive.machine.machine import Machine


@njit(cache=True)  # type: ignore[untyped-decorator]
def _is_inside(
    point: Float, planes: Float, first: int, last: int
) -> bool:  # pragma: no cover - compiled
    for p in range(first, last):
        if (
            planes[p, 0] * point[0] + planes[p, 1] * point[1] + planes[p, 2] * point[2]
            > planes[p, 3]
        ):
            return False
    return True


@njit(cache=True)  # type: ignore[untyped-decorator]
def _is_behind(
    point: Float, planes: Float, first: int, last: int, inset: float
) -> bool:  # pragma: no cover - compiled
    """Return whether the ray from the origin (the sensor) to a point crosses a shrunken shape.

    The planes are moved inwards by the inset. A shape around the origin is not crossed.
    """
    begin, end = 0.0, 1.0
    for p in range(first, last):
        d = planes[p, 3] - inset
        rise = planes[p, 0] * point[0] + planes[p, 1] * point[1] + planes[p, 2] * point[2]
        if rise > 0.0:
            end = min(end, d / rise)
        elif rise < 0.0:
            begin = max(begin, d / rise)
        elif d < 0.0:
            return False
        if begin >= end:
            return False
    return begin > 0.0  # otherwise the sensor is inside the shape, which then casts no shadow


@njit(cache=True)  # type: ignore[untyped-decorator]
def _posed(
    shapes: Float, starts: Int, spheres: Float, owners: Int, T_lidar_links: Float
) -> tuple[Float, Float]:  # pragma: no cover - compiled
    """Return all planes (K, P, 4) and spheres (K, S, 4) in the sensor's frame, K times."""
    planes = np.empty((len(T_lidar_links), len(shapes), 4))
    moved = np.empty((len(T_lidar_links), len(spheres), 4))
    for k in range(len(T_lidar_links)):
        for s in range(len(spheres)):
            T = T_lidar_links[k, owners[s]]
            c = spheres[s]
            for row in range(3):
                moved[k, s, row] = (
                    T[row, 0] * c[0] + T[row, 1] * c[1] + T[row, 2] * c[2] + T[row, 3]
                )
            moved[k, s, 3] = c[3]
            for p in range(starts[s], starts[s + 1]):
                distance = shapes[p, 3]
                for row in range(3):
                    n = (
                        T[row, 0] * shapes[p, 0]
                        + T[row, 1] * shapes[p, 1]
                        + T[row, 2] * shapes[p, 2]
                    )
                    planes[k, p, row] = n
                    distance += n * T[row, 3]
                planes[k, p, 3] = distance
    return planes, moved


@njit(cache=True)  # type: ignore[untyped-decorator]
def _own(
    points: Float,
    slices: Int,
    planes: Float,
    starts: Int,
    spheres: Float,
    casts: Bool,
    inset: float,
) -> Bool:  # pragma: no cover - compiled
    """Return which points are inside a shape or in its shadow.

    Each shape's sphere is tested first, which is quick and rules most shapes out: the ray from the
    origin to the point meets it only if the point is in it, or if the sphere's centre is nearer to
    the ray than its radius and lies between the two ends.
    """
    found = np.zeros(len(points), dtype=np.bool_)
    away2 = spheres[:, :, 0] ** 2 + spheres[:, :, 1] ** 2 + spheres[:, :, 2] ** 2
    radius2 = spheres[:, :, 3] ** 2
    for n in range(len(points)):
        s = slices[n]
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        length2 = x * x + y * y + z * z
        for shape in range(len(starts) - 1):
            sphere = spheres[s, shape]
            along = x * sphere[0] + y * sphere[1] + z * sphere[2]
            over2 = away2[s, shape] - radius2[s, shape]
            is_in = length2 - 2.0 * along + over2 <= 0.0
            if not is_in and (along <= 0.0 or along >= length2 or over2 * length2 > along * along):
                continue
            first, last = starts[shape], starts[shape + 1]
            if (is_in and _is_inside(points[n], planes[s], first, last)) or (
                casts[shape] and _is_behind(points[n], planes[s], first, last, inset)
            ):
                found[n] = True
                break
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Hull:
    """A padded convex shape in its link's frame: planes n·p ≤ d (P, 4), and a bounding sphere."""

    link: str
    planes: Float
    centre: Float
    radius_m: float


class SelfFilter:
    """Padded hulls of all links with their shadows, and a sphere around a held stone.

    A return behind a link is false: the beam's edge has hit the link, or the measured joint
    positions are a little off. It is said to lie in the link's shadow. The link that carries the
    sensor casts no shadow, because the sensor may be inside its hull.
    """

    def __init__(self, machine: Machine, padding_m: float, shadow_m: float = 0.0) -> None:
        """Prepare the shapes.

        Args:
            machine: The machine whose links are filtered.
            padding_m: Returns up to this distance from a link count as returns from it [m].
            shadow_m: A return is in a link's shadow if its ray passes the link at this distance or
                less [m]; 0 switches shadows off.
        """
        shapes = [
            (name, shape.vertices) for name, link in machine.links.items() for shape in link.shapes
        ]
        self._hulls = tuple(_hull(name, vertices, padding_m) for name, vertices in shapes)
        counts = [len(hull.planes) for hull in self._hulls]
        # The last shape is a sphere without planes, around what the gripper holds.
        self._starts = np.concatenate([[0], np.cumsum([*counts, 0])]).astype(np.int64)
        self._planes = np.vstack([hull.planes for hull in self._hulls])
        self._spheres = np.array(
            [[*hull.centre, hull.radius_m] for hull in self._hulls]
            + [[*machine.gripper.grasp_centre, 0.0]]
        )
        owners = [*(hull.link for hull in self._hulls), "gripper"]
        self._links = tuple(dict.fromkeys(owners))
        self._owners = np.array([self._links.index(owner) for owner in owners])
        self._inset_m = padding_m - shadow_m
        self._has_shadows = shadow_m > 0
        self._carriers = {sensor.name: sensor.link for sensor in machine.sensors_of("lidar")}

    def compile(self) -> None:
        """Compile the inner loops, so that no scan has to wait for them."""
        for lidar in tuple(self._carriers)[:1]:
            frames = dict.fromkeys((*self._links, lidar), np.eye(4))
            self.inside(np.zeros((1, 3)), np.zeros(1, dtype=np.int64), lidar, [frames], 0.0)

    def inside(
        self,
        points_lidar: Float,
        slices: Int,
        lidar: str,
        frames: list[Mapping[str, Float]],
        held_radius_m: float,
    ) -> Bool:
        """Return which returns lie on the machine, in its shadow, or on what it holds, shape (N,).

        Args:
            points_lidar: Returns in the sensor's frame [m], shape (N, 3).
            slices: Index into `frames` for the time of each point, shape (N,).
            lidar: Name of the sensor's frame.
            frames: T_base_frame by name, for each slice of time.
            held_radius_m: Radius of the sphere around the point between the jaws [m]; 0 for none.
        """
        T_base_links = np.array([[frame[link] for link in self._links] for frame in frames])
        T_lidar_base = np.array([inverse(frame[lidar]) for frame in frames])
        shapes = self._spheres.copy()
        shapes[-1, 3] = held_radius_m
        planes, spheres = _posed(
            self._planes, self._starts, shapes, self._owners, T_lidar_base[:, None] @ T_base_links
        )
        carrier = self._carriers[lidar]
        casts: Bool = np.array(
            [*(self._has_shadows and hull.link != carrier for hull in self._hulls), False]
        )
        points, which = read_only(points_lidar), read_only(slices)
        return np.asarray(_own(points, which, planes, self._starts, spheres, casts, self._inset_m))


def _hull(link: str, vertices: Float, padding_m: float) -> _Hull:
    facets = ConvexHull(vertices).equations  # n·p + offset ≤ 0
    planes = np.unique(np.round(np.column_stack([facets[:, :3], -facets[:, 3]]), 9), axis=0)
    planes[:, 3] += padding_m
    centre = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    # The corners of a padded box move outwards by √3 times the padding.
    radius_m = float(np.linalg.norm(vertices - centre, axis=1).max()) + np.sqrt(3) * padding_m
    return _Hull(link, planes, centre, radius_m)
