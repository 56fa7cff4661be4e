"""LZF, the compression inside PCD files (Lehmann's liblzf).

A packed stream is a sequence of literal bytes and of references to bytes unpacked before, at most
8192 bytes back. So a stream is unpacked piece by piece, and no more of it has to be in memory.
"""

import numpy as np
from numba import njit

_FARTHEST = 1 << 13  # bytes that a reference reaches back
_PIECE = 1 << 20  # bytes unpacked at a time where they are passed over


class Unpacker:
    """Unpacks a stream, a number of bytes at a time."""

    def __init__(self, packed: np.ndarray) -> None:
        """Begin at the first byte of a packed stream, shape (N,), uint8."""
        self._packed = packed
        self._place = np.zeros(3, dtype=np.int64)  # next byte, bytes left of a token, how far back
        self._newest = np.empty(0, dtype=np.uint8)

    def take(self, count: int) -> np.ndarray:
        """Return the next bytes, shape (count,); fewer if the stream ends or is damaged."""
        begun = len(self._newest)
        out = np.empty(begun + count, dtype=np.uint8)
        out[:begun] = self._newest
        ended = _unpack(self._packed, self._place, out, begun)
        self._newest = out[max(0, ended - _FARTHEST) : ended].copy()
        return out[begun:ended]

    def skip(self, count: int) -> None:
        """Pass over the next bytes."""
        for begun in range(0, count, _PIECE):
            self.take(min(_PIECE, count - begun))

    def copy(self) -> "Unpacker":
        """Return another unpacker at the same place of the stream."""
        other = Unpacker(self._packed)
        other._place, other._newest = self._place.copy(), self._newest
        return other


@njit(cache=True)  # type: ignore[untyped-decorator]
def _unpack(packed: np.ndarray, place: np.ndarray, out: np.ndarray, o: int) -> int:
    """Fill `out` from index o on; return where it ended, and leave in `place` how to go on.

    Bytes before o are those unpacked last. `place` holds the next packed byte, how many bytes of a
    token are left, and how far back they are; 0 for literal ones.
    """
    i, left, back = place[0], place[1], place[2]
    while o < len(out):
        if left == 0:
            i, left, back = _token(packed, i)
        length = min(left, len(out) - o)
        if left == 0 or back > o or (back == 0 and i + length > len(packed)):
            break
        if back == 0:
            out[o : o + length] = packed[i : i + length]
            i += length
        else:
            for k in range(length):  # one by one, because a reference may overlap its own output
                out[o + k] = out[o + k - back]
        o += length
        left -= length
    place[0], place[1], place[2] = i, left, back
    return o


@njit(cache=True)  # type: ignore[untyped-decorator]
def _token(packed: np.ndarray, i: int) -> tuple[int, int, int]:
    """Return where the bytes behind a token begin, its length and how far back it refers.

    The length is 0 where the stream ends.
    """
    if i >= len(packed):
        return i, 0, 0
    control = int(packed[i])
    i += 1
    if control < 32:  # a run of literal bytes
        return i, control + 1, 0
    length, back = control >> 5, (control & 31) << 8
    if length == 7 and i < len(packed):
        length += int(packed[i])
        i += 1
    if i >= len(packed):
        return i, 0, 0
    return i + 1, length + 2, back + int(packed[i]) + 1
