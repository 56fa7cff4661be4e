"""The joints of a structure, and what a stone at a place does to them: it covers, or leaves them.

A joint is the gap between two stones of one course that are beside one another along the structure.
A mason lays one stone over two: a joint that goes on through the next course is a crack in the
making. A stone covers a joint if it lies over it by enough to each side, and lets it run if it ends
there.
"""

import numpy as np

from executive.arrays import Bool, Float
from executive.messages.building import AsBuilt

_COURSE_M = 0.3  # centres of one course differ by less, those of two by more: half a stone
_GAP_M = 0.3  # ends that are nearer to one another are those of neighbours
_COVER_M = 0.10  # a stone lies over a joint by so much to each side, if it covers it
_NOISE_M = 0.05  # planned beyond that: 95 % of releases are off by less along the structure
_STEP_M = 0.2  # along a curve, over which its heading counts as one


class Joints:
    """The joints of a structure that no stone covers yet.

    Attributes:
        along: Where each is along the structure [m], shape (J,).
        z: Height of the higher of its two stones' centres [m], shape (J,).
    """

    def __init__(self, built: AsBuilt) -> None:
        self._structure = built.structure
        self._stones = np.zeros((0, 3))  # begin, end, height of the centre
        if len(built.structure.line) > 1:
            rows = [self._span(one.T_map_stone, one.stone.vertices) for one in built.standing]
            self._stones = np.array(rows).reshape(-1, 3)
        begin, end, z = self._stones.T
        gaps = self._apart(begin[None, :], end[:, None])  # of each stone's end and another's begin
        is_joint = (np.abs(z[:, None] - z[None, :]) < _COURSE_M) & (np.abs(gaps) < _GAP_M)
        is_joint &= self._apart(begin[None, :], begin[:, None]) > 0
        a, b = np.nonzero(is_joint)
        self.along, self.z = end[a] + gaps[a, b] / 2, np.maximum(z[a], z[b])
        if len(a):
            covers = self._over(begin, end, z, _COVER_M, 1.0)
            self.along, self.z = self.along[~covers.any(axis=0)], self.z[~covers.any(axis=0)]

    def closed(self, origins_map: Float, R: Float, vertices: Float) -> Float:
        """Return joints that a stone covers less those that it lets run, −1 to 1, shape (P,).

        Args:
            origins_map: Where the stone's origin would be, shape (P, 3) [m].
            R: Its rotation, shape (3, 3).
            vertices: Its surface [m], shape (V, 3).
        """
        if not len(self.along) or not len(origins_map):
            return np.zeros(len(origins_map))
        begin, end = self._spans(origins_map, vertices @ R.T)
        z = origins_map[:, 2]
        meets = self._over(begin, end, z, _COVER_M + _NOISE_M, -1.0)
        covers = self._over(begin, end, z, _COVER_M + _NOISE_M, 1.0)
        found = covers.sum(axis=1) - (meets & ~covers).sum(axis=1)
        return np.asarray(np.clip(found, -1, 1), dtype=np.float64)

    def lengths_m(self, origins_map: Float, R: Float, vertices: Float) -> Float:
        """Return how long a stone is along the structure at places, (P,) [m]; 0 on a cairn."""
        if len(self._structure.line) == 1:
            return np.zeros(len(origins_map))
        begin, end = self._spans(origins_map, vertices @ R.T)
        return np.asarray(end - begin)

    def left_m(self, origins_map: Float, R: Float, vertices: Float) -> Float:
        """Return the free lengths of the course before and after a stone, shape (P, 2) [m].

        Each goes to the next stone of the course, or to the end of the structure, and is 0 where
        there is none; it is infinite on a cairn, and beside a stone that is alone on a ring.
        """
        if len(self._structure.line) == 1 or not len(origins_map):
            return np.full((len(origins_map), 2), np.inf)
        begin, end = self._spans(origins_map, vertices @ R.T)
        ends = np.stack([begin, self._structure.length_m - end], axis=1)
        left = np.full_like(ends, np.inf) if self._structure.is_ring else ends
        its_begin, its_end, its_z = self._stones.T
        is_course = np.abs(origins_map[:, 2, None] - its_z) < _COURSE_M
        middles = self._apart((begin + end)[:, None] / 2, (its_begin + its_end) / 2)
        to_those = self._apart(begin[:, None], its_end), self._apart(its_begin, end[:, None])
        for side, sign in enumerate((1, -1)):
            is_there = is_course & (sign * middles > 0)
            gaps = np.where(is_there, to_those[side], np.inf)
            left[:, side] = np.minimum(left[:, side], gaps.min(axis=1, initial=np.inf))
        return np.maximum(left, 0.0)

    def _over(self, begin: Float, end: Float, z: Float, by_m: float, sign: float) -> Bool:
        """Return which stones lie over which joints by a length, or (sign −1) nearly do, (P, J)."""
        before = self._apart(self.along[None, :], begin[:, None])
        after = self._apart(end[:, None], self.along[None, :])
        is_above = z[:, None] > self.z[None, :] + _COURSE_M
        return np.asarray(is_above & (before > sign * by_m) & (after > sign * by_m))

    def _span(self, T: Float, vertices: Float) -> Float:
        begin, end = self._spans(T[None, :3, 3], vertices @ T[:3, :3].T)
        return np.array([begin[0], end[0], T[2, 3]])

    def _spans(self, origins_map: Float, turned: Float) -> tuple[Float, Float]:
        """Return where stones begin and end along the structure, (P,) each [m]."""
        along, _ = self._structure.along_across(origins_map[:, :2])
        steps = np.rint(along / _STEP_M)
        if len(self._structure.line) == 2:
            steps = np.zeros(len(along))
        ends = np.empty((2, len(along)))
        for step in np.unique(steps):
            heading = self._structure.heading_rad(float(step) * _STEP_M)
            reach = turned[:, :2] @ np.array([np.cos(heading), np.sin(heading)])
            ends[:, steps == step] = np.array([[reach.min()], [reach.max()]])
        return along + ends[0], along + ends[1]

    def _apart(self, a: Float, b: Float) -> Float:
        """Return a − b along the structure, the shorter way around a ring."""
        if not self._structure.is_ring:
            return np.asarray(a - b)
        half = self._structure.length_m / 2
        return np.asarray((a - b + half) % (2 * half) - half)
