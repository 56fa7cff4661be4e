"""Arrays that are checked once, where a value is made, and are read-only afterwards."""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from executive.errors import ShapeError

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Bool = NDArray[np.bool_]

_SMALL = 1000  # number of values up to which the quick test below is used


def checked(
    name: str, values: ArrayLike, *shape: int | None, dtype: Any = np.float64
) -> NDArray[Any]:
    """Return a read-only view of values as an array of a given shape.

    A contiguous array of the right type is not copied: do not write to it afterwards.

    Args:
        name: Name of the array, for messages.
        values: What is checked.
        shape: Expected lengths; `None` accepts any length.
        dtype: Type of the result.

    Raises:
        ShapeError: If the shape differs or a value is not finite.
    """
    array = np.ascontiguousarray(values, dtype=dtype)
    fits = array.shape == shape or (
        array.ndim == len(shape)
        and all(
            want is None or want == have for want, have in zip(shape, array.shape, strict=False)
        )
    )
    if not fits:
        wanted = "(" + ", ".join("N" if n is None else str(n) for n in shape) + ")"
        raise ShapeError(f"{name} has shape {array.shape}, expected {wanted}")
    if not all_finite(array):
        raise ShapeError(
            f"{name} holds {int((~np.isfinite(array)).sum())} values that are not finite"
        )
    return read_only(array)


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return a read-only view of an array, copied only if it is not contiguous.

    Compiled functions tell arrays that may be written to from others, and are compiled for each.
    What is handed to them in this way has one type, wherever it comes from.
    """
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view


def all_finite(array: NDArray[Any]) -> bool:
    """Return whether an array holds neither infinities nor NaN; integers are finite."""
    if array.dtype.kind != "f":
        return True
    # Quick test: a finite sum of squares means that all values are finite. It may overflow, so that
    # the full test below decides. On small arrays it takes a fifth of the time; on large ones it
    # would start the threads of the linear algebra library, which then spin for milliseconds.
    if array.size <= _SMALL and math.isfinite(np.vdot(array, array)):
        return True
    return bool(np.isfinite(array).all())
