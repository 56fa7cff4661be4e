"""XML elements with the lines that they begin at."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from executive.tree.problem import Mark, MissionFileError, Problem

# An element is two levels of YAML, and a mission file has at most 60; attributes may add some.
_MAX_DEPTH = 25


@dataclass(frozen=True, slots=True)
class XmlElement:
    """An element, with its place in the file."""

    tag: str
    attributes: Mapping[str, str]
    mark: Mark
    children: "list[XmlElement]" = field(default_factory=list)

    def get(self, name: str, otherwise: str = "") -> str:
        """Return an attribute's value."""
        return self.attributes.get(name, otherwise)


def read_elements(text: str, file: str) -> XmlElement:
    """Return the root element of an XML text.

    Raises:
        MissionFileError: If it is no XML, or declares entities.
    """
    reader = _Reader(file)
    try:
        reader.parser.Parse(text.encode("utf-8"), True)
    except expat.ExpatError as error:
        mark = Mark(file, error.lineno, error.offset + 1)
        told = f"no XML: {expat.errors.messages[error.code]}"
        raise MissionFileError([Problem(mark, told)]) from error
    if reader.root is None:
        raise MissionFileError([Problem(Mark(file), "no XML: it has no element")])
    return reader.root


class _Reader:
    def __init__(self, file: str) -> None:
        self._file = file
        self._open: list[XmlElement] = []
        self.root: XmlElement | None = None
        self.parser: Any = expat.ParserCreate("utf-8")
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.EntityDeclHandler = self._refuse

    def _mark(self) -> Mark:
        return Mark(self._file, self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self._open) >= _MAX_DEPTH:
            told = (
                f"nested more than {_MAX_DEPTH} elements deep, which a mission file cannot hold; "
                "move inner nodes into a BehaviorTree of their own"
            )
            raise MissionFileError([Problem(self._mark(), told)])
        element = XmlElement(tag, attributes, self._mark())
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        self._open.pop()

    def _refuse(self, name: str, *_: Any) -> None:
        told = f"the entity '{name}' is declared here; trees need none"
        raise MissionFileError([Problem(self._mark(), told)])
