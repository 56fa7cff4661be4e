"""What the header of an E57 file states, checked before a library reads and allocates by it.

Fields and their offsets are those of ASTM E2807, Sec. 7: pages of 1024 bytes, of which the last
four are a checksum, and a text in XML that says where everything else is.
"""

import re
import struct
from pathlib import Path

from executive.errors import DataError

MAGIC = b"ASTM-E57"
_HEADER = struct.Struct("<8sIIQQQQ")  # magic, version, lengths and places of file and text
_PAGE, _CONTENT = 1024, 1020  # bytes
# The standard has no document types. A library would load what they refer to, from anywhere.
_FOREIGN = re.compile(rb"<!\s*(DOCTYPE|ENTITY)|\0|\A(?!\s*<)", re.IGNORECASE)
_ENCODING = re.compile(rb"\A[^>]*encoding\s*=\s*[\"'](?!utf-8[\"'])", re.IGNORECASE)


def check_e57(path: Path) -> None:
    """Refuse a file whose header states what its length cannot hold, or whose text is no plain XML.

    Raises:
        DataError: If it does; the message names both numbers.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(_HEADER.size)
        if len(head) < _HEADER.size or not head.startswith(MAGIC):
            raise _damage(path, size, "it has no E57 header")
        _, _, _, length, text_at, text_bytes, page = _HEADER.unpack(head)
        if page != _PAGE:
            raise _damage(path, size, f"its pages have {page} bytes instead of {_PAGE}")
        if length != size:
            raise _damage(path, size, f"its header promises {length} bytes")
        pages = -(-(text_at % _PAGE + text_bytes) // _CONTENT)
        if text_bytes == 0 or text_at // _PAGE + pages > -(-size // _PAGE):
            raise _damage(path, size, f"it promises {text_bytes} bytes of XML at byte {text_at}")
        file.seek(text_at - text_at % _PAGE)
        paged = file.read(pages * _PAGE)
    text = b"".join(paged[at : at + _CONTENT] for at in range(0, len(paged), _PAGE))
    text = text[text_at % _PAGE :][:text_bytes].removeprefix(b"\xef\xbb\xbf")
    if _FOREIGN.search(text) or _ENCODING.search(text):
        raise _damage(path, size, "its text is no XML as E57 files have it")


def _damage(path: Path, size: int, what: str) -> DataError:
    return DataError(
        f"{path}: cut short or damaged: {what}; the file has {size} bytes; copy or export it again"
    )
