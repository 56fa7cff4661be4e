"""A picture of a site that two motions explain, and of the verdict."""

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from executive.arrays import Float
from executive.errors import DataError
from executive.interfaces.registration import Registrar
from executive.testing.subject import subject_of
from trials.twins import blocks

_LEAST_M = 0.2  # height from which points are drawn: above waves and ruts
TARGET, SOURCE = "#b5b5b5", "#d1495b"


def pictured(path: Path, seed: int) -> Path:
    """Draw a row of identical blocks, and a survey laid over it by the answer and by its rival.

    Raises:
        DataError: If the registration of this seed names no rival.
    """
    target, source, _ = blocks("row", seed)
    with subject_of("registration", "segment_shot", ()).started() as registrar:
        assert isinstance(registrar, Registrar)
        found = registrar.register(target, source, np.random.default_rng(0))
    if found.rival is None:
        raise DataError(f"seed {seed}: no rival: {found.reason}; draw another seed")
    motions = (
        ("the answer", found.T_target_source, found.scale),
        ("its rival", found.rival.T_target_source, found.rival.scale),
    )
    picture, axes = plt.subplots(2, 1, figsize=(10, 4.8), layout="constrained", sharex=True)
    for axis, (name, T, scale) in zip(axes, motions, strict=True):
        _dots(axis, target.points, TARGET, 4.0)
        _dots(axis, source.points @ (scale * T[:3, :3]).T + T[:3, 3], SOURCE, 0.8)
        axis.set(title=name, aspect="equal", ylim=(4, 6))
    axes[-1].set_xlabel("along the row [m]; grey: the map, red: the survey")
    verdict = "accepted" if found.accepted else "refused"
    ratio = found.rival.likelihood_ratio
    picture.suptitle(f"{verdict}: the rival is {ratio:.2g} times as likely as the answer")
    picture.savefig(path, dpi=75)
    return path


def _dots(axis: plt.Axes, points: Float, colour: str, size: float) -> None:
    raised = points[points[:, 2] > _LEAST_M]
    axis.plot(raised[:, 1], raised[:, 0], ".", ms=size, color=colour, rasterized=True)
