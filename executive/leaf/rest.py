"""Wait until the arm is at rest: the step before every plan that begins at its present place."""

from collections import deque
from collections.abc import Generator, Iterable

import numpy as np

from executive.arrays import Float
from executive.leaf.context import Context
from executive.machine.machine import Machine
from executive.messages.command import START_TOLERANCE

# [rad/s] or [m/s]: a slower joint is at rest; five times the noise of a good encoder's speed
_STANDING = 0.01
_STAYING = (
    0.4 * START_TOLERANCE
)  # [rad] or [m]: so does one that has not strayed farther over the window
_WINDOW_S = 1.0
_LIMIT_S = 10.0  # the slowest stop along a path takes less


class Rest:
    """Detects joints at rest, or shaking on the spot as the simulated jaws do in some postures."""

    def __init__(self) -> None:
        self._seen: deque[tuple[float, Float]] = deque()

    def add(self, now_s: float, position: Float, velocity: Float) -> bool:
        """Take positions and velocities, each (n,); return whether the joints are at rest."""
        self._seen.append((now_s, position))
        while len(self._seen) > 1 and now_s - self._seen[1][0] >= _WINDOW_S:
            self._seen.popleft()
        is_whole = now_s - self._seen[0][0] >= _WINDOW_S
        return bool(
            (np.abs(velocity) < _STANDING).all() or (is_whole and (self.strayed() < _STAYING).all())
        )

    def strayed(self) -> Float:
        """Return how far each joint strayed over the window [rad] or [m], shape (n,)."""
        return np.asarray(np.ptp([position for _, position in self._seen], axis=0))


def stop_limit_s(machine: Machine, joints: Iterable[str]) -> float:
    """Return the time after which joints that were told to stop must be at rest [s].

    Twice the longest stop of a single joint at its acceleration limit, because the curvature of a
    path may use up to half of that limit; what a stop with a load may take where the machine would
    tip; and the window in which shaking on the spot shows.
    """
    return 2.0 * machine.stop_s(joints) + machine.stance.longest_stop_s + _WINDOW_S


def come_to_rest(context: Context) -> Generator[None, None, str]:
    """Wait until no joint of the arm moves; the jaws may.

    A cancelled motion ends along its path some ticks later: a plan made before that begins
    where the arm no longer is.

    Returns:
        Why the wait was ended; empty if the arm is at rest.
    """
    rest, began_s, names = Rest(), context.now_s(), context.machine().arm_names
    while True:
        sample, now_s = context.joints(), context.now_s()
        velocity = np.array([sample.of(name)[1] for name in names])
        if rest.add(now_s, context.arm(), velocity):
            return ""
        if now_s - began_s >= _LIMIT_S:
            worst = int(rest.strayed().argmax())
            return (
                f"{names[worst]} still moves, by {rest.strayed()[worst]:.3f} within the last second"
            )
        yield None
