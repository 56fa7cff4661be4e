"""LZF, the compression inside PCD files (Lehmann's liblzf): runs of bytes, and references to bytes
before.
"""

import numpy as np
from numba import njit


@njit(cache=True)  # type: ignore[untyped-decorator]
def decompress(packed: np.ndarray, size: int) -> np.ndarray:
    """Return the first bytes, as many as can be unpacked but at most `size`; damaged input ends the
    result early.
    """
    out = np.empty(size, dtype=np.uint8)
    i, o = 0, 0
    while i < len(packed) and o < size:
        control = int(packed[i])
        i += 1
        if control < 32:  # a run of literal bytes
            length = min(control + 1, size - o)
            if i + length > len(packed):
                break
            out[o : o + length] = packed[i : i + length]
            i += control + 1
        else:
            length, back = control >> 5, (control & 31) << 8
            if length == 7 and i < len(packed):
                length += int(packed[i])
                i += 1
            if i >= len(packed):
                break
            back += int(packed[i]) + 1
            i += 1
            if back > o:
                break
            length = min(length + 2, size - o)
            for k in range(length):  # a reference may overlap what it writes
                out[o + k] = out[o + k - back]
        o += length
    return out[:o]
