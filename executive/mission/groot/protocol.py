"""Messages of the Groot2 protocol, version 2, as BehaviorTree.CPP 4.10 speaks it.

A request is a header of 6 bytes and at most one part more; a reply is a header of 22 bytes and at
most one part more, or the two parts `error` and a text. Source: `groot2_protocol.h` and
`groot2_publisher.cpp` of BehaviorTree.CPP.
"""

import struct
from enum import StrEnum

VERSION = 2
TREE_ID_BYTES = 16
_HEADER = struct.Struct("<BcI")  # version, type, number of the request
_STATUS = struct.Struct("<HB")  # number of the node, status


class Type(StrEnum):
    """What is requested."""

    TREE = "T"
    STATUS = "S"
    BLACKBOARD = "B"
    INSERT_HOOK = "I"
    REMOVE_HOOK = "R"
    REMOVE_ALL_HOOKS = "A"
    DISABLE_ALL_HOOKS = "X"
    DUMP_HOOKS = "D"
    REACHED = "N"  # published: a breakpoint holds the tree
    UNLOCK = "U"


class GrootError(Exception):
    """A request cannot be followed; the text is replied."""


def request_type(header: bytes) -> Type:
    """Return what a request is for.

    Raises:
        GrootError: If the header is none, or of a type that is not offered.
    """
    if len(header) != _HEADER.size:
        raise GrootError("wrong request header")
    _, letter, _ = _HEADER.unpack(header)
    try:
        return Type(letter.decode("latin-1"))
    except ValueError:
        raise GrootError("Request not recognized") from None


def reply_header(request: bytes, tree_id: bytes) -> bytes:
    """Return the header of a reply."""
    _, letter, number = _HEADER.unpack(request)
    return _HEADER.pack(VERSION, letter, number) + tree_id


def notice_header(number: int) -> bytes:
    """Return the header of what is published when a breakpoint is reached."""
    return _HEADER.pack(VERSION, Type.REACHED.encode(), number & 0xFFFFFFFF)


def status_bytes(statuses: dict[int, int]) -> bytes:
    """Return the statuses of nodes by their numbers."""
    return b"".join(_STATUS.pack(uid, status) for uid, status in statuses.items())
