"""A packed stream is the same stream however it is unpacked."""

import numpy as np
import pytest

from executive.clouds.lzf import Unpacker


def packed_stream(seed: int) -> tuple[bytes, bytes]:
    """Return a random stream, packed and unpacked: literal runs, and references of all lengths."""
    rng, packed, plain = np.random.default_rng(seed), bytearray(), bytearray()
    while len(plain) < 60_000:
        if not plain or rng.integers(3) == 0:
            literal = rng.bytes(int(rng.integers(1, 33)))
            packed += bytes([len(literal) - 1]) + literal
            plain += literal
            continue
        back = int(rng.integers(1, min(len(plain), 8192) + 1))
        length = int(rng.integers(3, 265))
        high, low = divmod(back - 1, 256)
        long = [7 << 5 | high, length - 9] if length >= 9 else [length - 2 << 5 | high]
        packed += bytes([*long, low])
        for _ in range(length):
            plain.append(plain[-back])
    return bytes(packed), bytes(plain)


@pytest.mark.parametrize("seed", range(3))
def test_pieces_of_a_stream_make_the_whole(seed: int) -> None:
    packed, plain = packed_stream(seed)
    rng, unpacker = np.random.default_rng(seed), Unpacker(np.frombuffer(packed, np.uint8))
    found = b""
    while len(found) < len(plain):
        found += unpacker.take(int(rng.integers(1, 3000))).tobytes()
    assert found == plain
    assert unpacker.take(1).size == 0


def test_a_copy_goes_on_from_where_it_was_made() -> None:
    packed, plain = packed_stream(4)
    first = Unpacker(np.frombuffer(packed, np.uint8))
    first.skip(10_001)
    second = first.copy()
    assert first.take(500).tobytes() == plain[10_001:10_501]
    assert second.take(9000).tobytes() == plain[10_001:19_001]
    assert first.take(500).tobytes() == plain[10_501:11_001]


def test_a_reference_before_the_beginning_ends_the_stream() -> None:
    damaged = np.array([1, 65, 66, 0x20, 9], np.uint8)
    assert Unpacker(damaged).take(5).tobytes() == b"AB"
