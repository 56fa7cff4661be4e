"""Corrections that wait for a filter in one piece of memory, and all of them in one compiled call.

Between two inertial samples the processor's caches cool. A sample with two fixes and a chassis at
rest called compiled code eight times; what Python did between these calls, with cold caches, took
as long as a correction.
"""

import numpy as np
from executive_plugins.estimation.gate.innovation_record import DOUBTED, INNOVATIONS_TYPE
from executive_plugins.estimation.kalman.judged_fix import USED, use_fix
from executive_plugins.estimation.kalman.layout import FILTER_TYPE, Block
from executive_plugins.estimation.kalman.packed_correction import report_until
from executive_plugins.estimation.kalman.packed_measurements import correct_by_standstill
from executive_plugins.estimation.kalman.packed_prediction import SAMPLES_TYPE, predict_until
from executive_plugins.estimation.live.kernels import anchor, report, take
from executive_plugins.estimation.live.layout import ESTIMATE, LIVE
from executive_plugins.estimation.live.packed_state import ROW
from numba import from_dtype, njit, types

ROOM = 64  # corrections: two antennas at 20 Hz and ten of standstill, for more than a second
NOT_PACKED, FIX, STANDING, LOOK = 0, 1, 2, 3  # kinds
# What `follow_queue` says beside the bits of `use_fix`.
REPORTED, REFUSED_STANDING, LEFT_TO_CALLER, NOT_FINITE = -1, -2, -3, -4

CORRECTION = np.dtype(
    [
        ("stamp_s", "f8"),
        ("kind", "i8"),
        ("antenna", "i8"),  # its place among the innovations
        ("arm", "f8", (3,)),
        ("p", "f8", (3,)),
        ("covariance", "f8", (3, 3)),  # as declared, and scaled; see `use_fix`
        ("late_s", "f8"),
        ("rate_cabin", "f8", (3,)),
        ("sway_m_s", "f8"),
        ("sway_rad_s", "f8"),
    ],
    align=True,
)
"""A fix, see `Fix`, a chassis at rest, see `ChassisRest`, or the time at which the caller looks at
the filter."""

QUEUE = np.dtype(
    [
        ("order", "i8", (ROOM,)),  # places of the corrections in `rows`, by time
        ("next", "i8"),  # of `order`
        ("due", "i8"),  # end of those in `order` that are due
        ("first", "i8"),  # number of the first sample that is newer than the filter
        ("used", "i8"),  # number of fixes that the newest call has used
        ("used_s", "f8"),  # time of the newest of them
        ("moving_s", "f8"),  # when the chassis was seen to move last
        # Constants of a chassis at rest, see `correct_by_standstill`.
        ("doubt_s", "f8"),
        ("T_imu_cabin", "f8", (4, 4)),
        ("velocity_std_m_s", "f8"),
        ("rate_std_rad_s", "f8"),
        ("gate", "f8"),
        ("rows", CORRECTION, (ROOM,)),
    ],
    align=True,
)
_LIVE, _ROW = from_dtype(LIVE)[::1], from_dtype(ROW)[::1]
_QUEUE, _ESTIMATE = from_dtype(QUEUE)[::1], from_dtype(ESTIMATE)[::1]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _correct(block: Block, innovations: Block, q: np.record, c: np.record) -> int:
    """Correct by one measurement; return what is left to the caller, or `REPORTED` if nothing is.

    A chassis that drives smoothly looks as if it were at rest: after a contradiction, standstill
    is ignored for some time.
    """
    stamp_s = block[0].sample.stamp_s
    if c.kind == FIX:
        record = innovations[c.antenna : c.antenna + 1]
        said = int(use_fix(block, record, c.arm[:], c.p[:], c.covariance[:], c.late_s, True))
        if said & DOUBTED or not said & USED:
            return said
        q.used += 1
        q.used_s = stamp_s
        return REPORTED
    if stamp_s - q.moving_s < q.doubt_s:
        return REPORTED
    velocity_m_s, rate_rad_s, T = q.velocity_std_m_s, q.rate_std_rad_s, q.T_imu_cabin[:]
    is_used = correct_by_standstill(
        block, T, c.rate_cabin[:], velocity_m_s, rate_rad_s, c.sway_m_s, c.sway_rad_s, q.gate
    )
    return REPORTED if is_used else REFUSED_STANDING


@njit(  # type: ignore[untyped-decorator]
    types.int64(
        *(_LIVE, SAMPLES_TYPE, FILTER_TYPE, _QUEUE, INNOVATIONS_TYPE, _ESTIMATE, _ROW),
        *(types.int64, types.float64, types.boolean),
    ),
    cache=True,
)
def follow_queue(  # noqa: PLR0913 - compiled code takes the arrays of a problem one by one
    live: Block,
    ring: Block,
    block: Block,
    queue: Block,
    innovations: Block,
    estimate: Block,
    row: Block,
    end: int,
    until_s: float,
    is_corrected: bool,
) -> int:
    """Advance a filter by the corrections that are due, and propagate its state from there.

    Args:
        live: The propagator's block, shape (1,), dtype `LIVE`.
        ring: Its samples, dtype `SAMPLE`.
        block: The filter, shape (1,), dtype `FILTER`.
        queue: The corrections, shape (1,), dtype `QUEUE`.
        innovations: Those of all antennas, dtype `INNOVATIONS`.
        estimate: Result, the filter's state, shape (1,), dtype `ESTIMATE`.
        row: Result, the report of the newest sample, shape (1,), dtype `ROW`.
        end: Number after the newest sample.
        until_s: To which time the filter is advanced [s].
        is_corrected: Whether its state replaces the propagator's, or the covariance alone.

    Returns:
        `REPORTED` if all was done, or `NOT_FINITE` if the state was not finite and is not reported.
        Otherwise the next correction in the queue is left to the caller: the bits of `use_fix` say
        of a fix what was found, `REFUSED_STANDING` that the chassis was not at rest, and
        `LEFT_TO_CALLER` that it is no correction that this code makes. The filter is advanced to
        its time unless its kind is `NOT_PACKED`: then the time is not in this memory.
    """
    q = queue[0]
    q.used = 0
    while q.next < q.due:
        c = q.rows[q.order[q.next]]
        if c.kind == NOT_PACKED:
            return LEFT_TO_CALLER
        if c.stamp_s > block[0].sample.stamp_s:
            q.first = predict_until(block, ring, q.first, end, c.stamp_s)
        if c.kind == LOOK:
            return LEFT_TO_CALLER
        said = _correct(block, innovations, q, c)
        if said != REPORTED:
            return int(said)
        q.next += 1
    q.first = report_until(block, ring, q.first, end, until_s, estimate)
    if not is_corrected:
        anchor(live, estimate)
    elif not take(live, estimate, True):
        return NOT_FINITE
    report(live, row)
    return REPORTED
