"""LZF, the compression inside PCD files (Lehmann's liblzf).

A packed stream is a sequence of literal bytes and of references to bytes unpacked before.
"""

import numpy as np
from numba import njit


@njit(cache=True)  # type: ignore[untyped-decorator]
def decompress(packed: np.ndarray, size: int) -> np.ndarray:
    """Return the unpacked bytes, at most `size`; fewer if the input is damaged."""
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
            for k in range(length):  # one by one, because a reference may overlap its own output
                out[o + k] = out[o + k - back]
        o += length
    return out[:o]
