"""Curves that are driven forwards or backwards, joined to one path."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.driving.dubins import Curve

from executive.messages.drive import BasePath


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A curve and how it is driven.

    Attributes:
        curve: The curve; its headings are those of travel.
        direction: 1 forwards, −1 backwards: the machine then looks the other way.
    """

    curve: Curve
    direction: int


def joined(pieces: Sequence[Piece], step_m: float) -> BasePath:
    """Return one path through pieces, each of which starts where the one before ends.

    Where the direction changes, the pose is there twice.
    """
    poses, curvatures, directions = [], [], []
    for before, piece in zip([None, *pieces], pieces, strict=False):
        places, curvature = piece.curve.sampled(step_m)
        is_same = before is not None and before.direction == piece.direction
        turned = 0.0 if piece.direction == 1 else np.pi
        poses.append((places - [0.0, 0.0, turned])[int(is_same) :])
        curvatures.append(piece.direction * curvature[int(is_same) :])
        directions += [piece.direction] * len(poses[-1])
    path = np.concatenate(poses)
    path[:, 2] = np.unwrap(path[:, 2])
    ways = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(ways)])
    return BasePath(path, along, np.concatenate(curvatures), np.array(directions))
