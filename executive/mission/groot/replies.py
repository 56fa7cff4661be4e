"""What is replied to the requests of a Groot2 client."""

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from executive.mission.groot.breakpoints import Breakpoints
from executive.mission.groot.protocol import (
    GrootError,
    Type,
    reply_header,
    request_type,
    status_bytes,
)
from executive.mission.groot.shown_tree import ShownTree


class Replies:
    """Replies for one tree. A request that is wrong is replied with what is wrong."""

    def __init__(self, tree: ShownTree, breakpoints: Breakpoints) -> None:
        self._tree = tree
        self._breakpoints = breakpoints
        self._without_part: Mapping[Type, Callable[[], bytes | None]] = {
            Type.TREE: lambda: tree.xml.encode(),
            Type.STATUS: lambda: status_bytes(tree.statuses()),
            Type.DUMP_HOOKS: lambda: json.dumps(breakpoints.as_json()).encode(),
            Type.REMOVE_ALL_HOOKS: breakpoints.remove_all,
            Type.DISABLE_ALL_HOOKS: breakpoints.disable_all,
        }
        self._with_part: Mapping[Type, Callable[[bytes], bytes | None]] = {
            Type.BLACKBOARD: self._blackboards,
            Type.INSERT_HOOK: self._insert,
            Type.REMOVE_HOOK: lambda part: breakpoints.remove(_read(part)),
            Type.UNLOCK: lambda part: breakpoints.unlock(_read(part)),
        }

    def reply(self, parts: Sequence[bytes]) -> list[bytes]:
        """Return the parts of the reply to a request."""
        try:
            kind = request_type(parts[0])
            payload = self._payload(kind, parts)
        except GrootError as error:
            return [b"error", str(error).encode()]
        header = reply_header(parts[0], self._tree.id)
        return [header] if payload is None else [header, payload]

    def _payload(self, kind: Type, parts: Sequence[bytes]) -> bytes | None:
        if kind in self._without_part:
            return self._without_part[kind]()
        if kind not in self._with_part:
            raise GrootError("Request not recognized")
        if len(parts) != 2:
            raise GrootError("must be 2 parts message")
        return self._with_part[kind](parts[1])

    def _blackboards(self, part: bytes) -> bytes:
        import msgpack

        names = [name for name in part.decode(errors="replace").split(";") if name]
        found: bytes = msgpack.packb(self._tree.blackboards(names), default=str)
        return found

    def _insert(self, part: bytes) -> None:
        wanted = _parsed(part)
        for one in wanted if isinstance(wanted, list) else [wanted]:
            self._breakpoints.insert(_mapping(one))


def _parsed(part: bytes) -> Any:
    try:
        return json.loads(part)
    except (ValueError, RecursionError) as error:
        raise GrootError("the second part is no JSON") from error


def _mapping(value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise GrootError("a hook is a JSON object")
    return value


def _read(part: bytes) -> dict[str, Any]:
    return _mapping(_parsed(part))
