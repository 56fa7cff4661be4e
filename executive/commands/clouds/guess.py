"""Where to begin an alignment: numbers on the command line, or a file that another command has
written.
"""

import json
from pathlib import Path

import numpy as np

from executive.arrays import Float
from executive.errors import ConfigError
from executive.geometry.pose import pose_xyz_rpy

_FORMS = (
    "give x,y,z or x,y,z,roll,pitch,yaw (metres, degrees), or a file with a 4×4 matrix or "
    "an answer of --json"
)


def read_guess(text: str | None, option: str = "--guess") -> tuple[Float, float]:
    """Return T_target_source, shape (4, 4), and the source's scale; without a text, no motion and
    1.

    Args:
        text: What was given, if anything was.
        option: The option that it was given to, for messages.

    Raises:
        ConfigError: If the text is neither numbers nor a file with a rigid motion.
    """
    if text is None:
        return np.eye(4), 1.0
    path = Path(text)
    if path.is_file():
        T, scale = _from_file(path, option)
        return _rigid(text, T, option), scale
    words = text.split(",")
    try:
        numbers = np.array([float(word) for word in words])
    except ValueError:
        raise ConfigError(f"{option}: '{text}' is neither numbers nor a file; {_FORMS}") from None
    if len(numbers) not in (3, 6) or not np.isfinite(numbers).all():
        raise ConfigError(
            f"{option}: '{text}' holds {len(numbers)} numbers, not 3 or 6 finite ones; {_FORMS}"
        )
    return pose_xyz_rpy(
        numbers[:3], np.radians(np.append(numbers[3:], np.zeros(6 - len(numbers))))
    ), 1.0


def _from_file(path: Path, option: str) -> tuple[Float, float]:
    try:
        content = path.read_text(encoding="utf-8")
        if content.lstrip().startswith(("{", "[")):
            read = json.loads(content)
            values, scale = (
                (read["T"], float(read.get("scale", 1.0)))
                if isinstance(read, dict)
                else (read, 1.0)
            )
            return np.array(values, dtype=float), scale
        return np.array(
            [
                [float(word) for word in line.split()]
                for line in content.splitlines()
                if line.strip()
            ]
        ), 1.0
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise ConfigError(f"{option}: {path} holds no 4×4 matrix ({error}); {_FORMS}") from error


def _rigid(text: str, T: Float, option: str) -> Float:
    """Check a matrix; a rotation that was printed with four digits is made exact."""
    if T.shape != (4, 4) or not np.isfinite(T).all() or not np.allclose(T[3], [0, 0, 0, 1]):
        raise ConfigError(f"{option}: {text} holds no 4×4 matrix of a motion; {_FORMS}")
    U, sizes, V = np.linalg.svd(T[:3, :3])
    R = U @ V
    if np.abs(sizes - 1).max() > 1e-3 or np.linalg.det(R) < 0:
        raise ConfigError(
            f"{option}: the rotation in {text} is none: it scales or mirrors; {_FORMS}"
        )
    rigid = T.copy()
    rigid[:3, :3] = R
    return rigid
