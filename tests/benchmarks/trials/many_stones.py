"""Sites of 99 stones, registered in a process that draws no scene.

The ray caster that draws the other scenes takes 200 MB, which the registration does not.
"""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.interfaces.registration import Registrar
from executive.messages.cloud import Cloud
from executive.testing.subject import subject_of
from trials.registration_trial import Trial, tried

SAME, OTHERS = "99 stones", "99 others"


@dataclass(frozen=True, slots=True)
class ManyStones:
    """What two registrations of 99 stones gave and took.

    Attributes:
        trials: A wrong site, and the right one.
        peak_mb: Most memory of their process.
    """

    trials: tuple[Trial, ...]
    peak_mb: float


def many_stones() -> ManyStones:
    """Register 99 stones with others and with themselves, in a process of their own."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return process.submit(_registered).result()


def _registered() -> ManyStones:
    T = pose(exp_so3(np.array([0.02, 0.03, 2.0])), np.array([4.0, -3.0, 1.0]))
    target, trials = Cloud("map", field(11, 2, 99)), list[Trial]()
    with subject_of("registration", "segment_shot", ()).started() as plugin:
        assert isinstance(plugin, Registrar)
        for kind, shape_seed in ((OTHERS, 12), (SAME, 11)):
            source = Cloud("survey", transform(inverse(T), field(shape_seed, 3, 99)))
            trials.append(tried(plugin, kind, target, source, T))
    return ManyStones(tuple(trials), peak_mb())


def peak_mb() -> float:
    """Return the most memory of this program; `getrusage` has that of the program that began it."""
    status = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    peaks_kb = [int(line.split()[1]) for line in status if line.startswith("VmHWM")]
    return peaks_kb[0] / 1024


def field(shape_seed: int, seed: int, count: int) -> Float:
    """Return so many lumps on a loose grid [m]; one shape seed is one site."""
    shape, rng = np.random.default_rng(shape_seed), np.random.default_rng(seed)
    side = int(np.ceil(np.sqrt(count)))
    xy = rng.uniform(-1, 2.2 * side + 1, (int((2.2 * side + 2) ** 2 * 400), 2))
    parts = [np.column_stack([xy, 0.03 * np.sin(0.7 * xy[:, 0] + shape_seed)])]
    for k in range(count):
        place = np.array([k % side, k // side]) * 2.2 + 1.1 + shape.uniform(-0.35, 0.35, 2)
        size, squeeze = shape.uniform(0.4, 0.6), shape.uniform(0.6, 1, 3)
        waves, phases = shape.normal(0, 2, (3, 3)), shape.uniform(0, 6, 3)
        d = rng.normal(size=(3000, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        lump = d * (size * (1 + 0.12 * np.sin(d @ waves + phases).sum(axis=1)))[:, None] * squeeze
        lump += [*place, 0.25]
        parts.append(lump[lump[:, 2] > 0])
    points = np.vstack(parts)
    return np.asarray(points + rng.normal(0, 0.01, points.shape))
