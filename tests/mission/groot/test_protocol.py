"""Headers of the Groot2 protocol: requests that are known, and those that are refused."""

import pytest

from executive.mission.groot.protocol import (
    GrootError,
    Type,
    notice_header,
    reply_header,
    request_type,
)


@pytest.mark.parametrize("kind", list(Type))
def test_a_request_is_known_by_its_letter(kind: Type) -> None:
    assert request_type(bytes([2]) + kind.encode() + bytes(4)) is kind


@pytest.mark.parametrize("letter", [b"Z", b"t", b"\xff", b"\0"])
def test_a_type_that_is_not_offered_is_refused(letter: bytes) -> None:
    with pytest.raises(GrootError, match="Request not recognized"):
        request_type(bytes([2]) + letter + bytes(4))


@pytest.mark.parametrize("header", [b"", b"\x02T\0\0\0", b"\x02T" + bytes(5)])
def test_a_header_of_another_length_is_refused(header: bytes) -> None:
    with pytest.raises(GrootError, match="wrong request header"):
        request_type(header)


def test_a_reply_has_the_number_of_its_request_and_a_notice_its_own() -> None:
    request = bytes([7]) + b"S" + (513).to_bytes(4, "little")
    assert reply_header(request, b"tree") == bytes([2]) + b"S" + request[2:] + b"tree"
    assert notice_header(258) == bytes([2]) + b"N" + (258).to_bytes(4, "little")
    assert notice_header(2**32 + 5) == notice_header(5)
