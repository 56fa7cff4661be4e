"""Wait until the arm stands: the step before every plan that begins where the arm is."""

from collections.abc import Generator

import numpy as np

from executive.behaviours.context import Context
from executive.messages.joints import JointSample

_STANDING = 0.01  # [rad/s] or [m/s]: a joint slower than this stands; five times the noise of a good encoder's speed
_LIMIT_S = 10.0  # the slowest stop along a path takes less


def is_standing(sample: JointSample) -> bool:
    """Tell whether no joint of a sample moves."""
    return bool((np.abs(sample.velocity) < _STANDING).all())


def come_to_rest(context: Context) -> Generator[None, None, str]:
    """Wait until no joint of the arm moves; the jaws may.

    A motion that was given up ends along its path some ticks later: a plan made before that begins where the arm no
    longer is.

    Returns:
        Why waiting was given up; empty if the arm stands.
    """
    began_s, names = context.now_s(), context.machine().arm_names
    while True:
        sample = context.joints()
        speeds = np.abs([sample.of(name)[1] for name in names])
        if (speeds < _STANDING).all():
            return ""
        if context.now_s() - began_s >= _LIMIT_S:
            worst = int(speeds.argmax())
            return f"{names[worst]} still moves at {speeds[worst]:.3f} per second after {_LIMIT_S:.0f} s"
        yield None
