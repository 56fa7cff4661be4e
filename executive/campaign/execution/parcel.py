"""The files of a run on their way from a worker to the campaign's folder."""

import io
import zipfile
from collections.abc import Sequence
from pathlib import Path

from executive.campaign.execution.inputs import safe_name
from executive.errors import DataError

NOT_KEPT = "not_kept.txt"  # which files of a run were not sent, and why


def pack(folder: Path, patterns: Sequence[str], limit_bytes: int) -> bytes:
    """Pack the files of a run that are kept as a ZIP archive.

    Small files first: a file that would make the archive's content larger than the limit is left
    out, and named in `not_kept.txt` in the archive.

    Args:
        folder: Folder of the run.
        patterns: Glob patterns relative to it.
        limit_bytes: Limit of the sizes of the files together, before they are packed [byte].
    """
    kept = {one for pattern in patterns for one in folder.glob(pattern) if _is_own_file(one)}
    packed = io.BytesIO()
    left_out: list[str] = []
    total = 0
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for file in sorted(kept, key=lambda one: (one.stat().st_size, one)):
            name, size = file.relative_to(folder).as_posix(), file.stat().st_size
            if total + size > limit_bytes:
                left_out.append(f"{name}: {size} bytes, beyond the limit of {limit_bytes}\n")
                continue
            total += size
            archive.write(file, name)
        if left_out:
            archive.writestr(NOT_KEPT, "".join(left_out))
    return packed.getvalue()


def unpack(packed: bytes, folder: Path, limit_bytes: int) -> None:
    """Write the files of a run into the campaign's folder for it.

    Raises:
        DataError: If the archive is broken, a name leads out of the folder, or the files are
            larger than the limit that they were packed with. Nothing is written then.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(packed)) as archive:
            entries = archive.infolist()
            names = [safe_name(one.filename) for one in entries]
            if sum(one.file_size for one in entries if one.filename != NOT_KEPT) > limit_bytes:
                raise DataError(f"the files of a run are larger than {limit_bytes} bytes")
            for entry, name in zip(entries, names, strict=True):
                target = folder / name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(archive.read(entry))
    except zipfile.BadZipFile as error:
        raise DataError(f"the files of a run did not arrive whole: {error}") from error


def _is_own_file(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()
