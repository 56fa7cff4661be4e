"""Arrays that are checked once, at the border, and read-only from then on."""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from executive.errors import ShapeError

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Bool = NDArray[np.bool_]

_SMALL = 1000  # values


def checked(
    name: str, values: ArrayLike, *shape: int | None, dtype: Any = np.float64
) -> NDArray[Any]:
    """Return a read-only array of the wanted shape; `None` stands for any length.

    A fresh contiguous array is kept and locked, not copied: hand it over and do not write to it
    afterwards.

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
    # The sum of squares is finite only if all are, and costs a fifth on small arrays; it may also
    # overflow. On large ones it would wake the threads of the linear algebra, which spin for
    # milliseconds.
    is_surely_finite = (
        array.size <= _SMALL and array.dtype.kind == "f" and math.isfinite(np.vdot(array, array))
    )
    if array.dtype.kind == "f" and not is_surely_finite and not np.isfinite(array).all():
        raise ShapeError(
            f"{name} holds {int((~np.isfinite(array)).sum())} values that are not finite"
        )
    view = array.view()
    view.flags.writeable = False
    return view
