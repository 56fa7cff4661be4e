"""Solutions of the sparse systems of a stiff grid, one after the other."""

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from executive.arrays import Float

_SETTLED = 1e-12  # error of a solution, in it, in the norm of the system: rounding
_MOST_STEPS = 40  # as costly as factors of a site of 2,500 nodes; 9 to 12 settle
# Without factors: a tenth of a millimetre in a metre, and steps as costly as factors.
_SETTLED_WIDE, _MOST_STEPS_WIDE = 1e-4, 1000


class GridSolver:
    """Solves symmetric, positive definite systems that differ little from one another.

    The first is factored; the others are solved by conjugate gradients, to which these factors are
    the preconditioner: a third of the time, and the same up to rounding. Without factors, all are
    solved up to a tenth of a millimetre in a metre: where nodes are far apart, points hold nearly
    all of them and bending little, so that few steps settle. Where they do not, it is factored.
    """

    def __init__(self, has_factors: bool = True) -> None:
        self._has_factors = has_factors
        self._factors: SuperLU | None = None
        self._last = np.zeros(0)

    def solved(self, system: sparse.csc_array, right: Float) -> Float:
        """Return the solution, shape (N,); factors anew if steps do not settle."""
        if self._stepped(system, right):
            return self._last
        self._factors = splu(  # without pivots: two thirds of the usual time
            system,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        self._last = np.asarray(self._factors.solve(right))
        return self._last

    def _stepped(self, system: sparse.csc_array, right: Float) -> bool:
        """Step to the solution from the last one, if that can be done; return whether it was."""
        if self._has_factors:
            factors, limits = self._factors, (_SETTLED, _MOST_STEPS)
            return factors is not None and self._by_steps(factors.solve, system, right, *limits)
        if not len(self._last):
            self._last = np.zeros(len(right))
        diagonal, limits = system.diagonal(), (_SETTLED_WIDE, _MOST_STEPS_WIDE)
        return self._by_steps(lambda left: left / diagonal, system, right, *limits)

    def _by_steps(
        self,
        improved: Callable[[Float], Float],
        system: sparse.csc_array,
        right: Float,
        settled: float,
        most_steps: int,
    ) -> bool:
        """Step from the last solution to that of this system; return whether it is reached."""
        found = self._last.copy()
        left = right - system @ found
        better = improved(left)
        way, square = better, float(left @ better)
        enough = settled**2 * float(right @ improved(right))
        for _ in range(most_steps):
            if square <= enough:
                self._last = found
                return True
            pushed = system @ way
            length = square / float(way @ pushed)
            found += length * way
            left -= length * pushed
            better = improved(left)
            before, square = square, float(left @ better)
            way = better + square / before * way
        return False
