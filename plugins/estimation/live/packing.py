"""Conversion of samples and estimates to and from rows of the shared memory block."""

import numpy as np
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.kernels import Block, has_finite_values, write_estimate
from executive_plugins.estimation.live.layout import ESTIMATE, SAMPLES
from executive_plugins.estimation.live.modes import Mode

from executive.arrays import Float

MODES = tuple(Mode)


def samples_from(block: Block, first: int, end: int) -> list[Inertial]:
    """Return copies of samples, as far as the block still holds them.

    Another process may write further ones meanwhile: those that it may have written over while they
    were copied are left out.

    Args:
        block: Shape (1,), dtype `LIVE`.
        first: Number of the first sample, counted from 0.
        end: Number after the last.
    """
    kept = np.arange(max(first, end - SAMPLES, 0), end)
    rows = block["samples"][0][kept % SAMPLES]
    # The place of sample n is that of sample n + SAMPLES, which is written before it is counted.
    whole = kept > int(block["written"][0]) - SAMPLES
    return [sample_of(row) for row in rows[whole]]


def sample_of(row: Block) -> Inertial:
    """Return a copy of the sample in a row, dtype `SAMPLE`."""
    return Inertial(
        float(row["stamp_s"]), row["rate"].copy(), row["force"].copy(), float(row["since_last_s"])
    )


def packed(state: InertialState, covariance: Float) -> Block:
    """Return a state and its covariance (15, 15) as a row of mode GLOBAL, shape (1,)."""
    return packed_estimate(Estimate(state, covariance, Mode.GLOBAL, (), {}))


def packed_estimate(estimate: Estimate) -> Block:
    """Return an estimate as a row, shape (1,), dtype `ESTIMATE`; see `pack_into`."""
    row = np.zeros(1, ESTIMATE)
    pack_into(row, estimate)
    return row


def pack_into(row: Block, estimate: Estimate) -> None:
    """Write an estimate into a row, shape (1,), dtype `ESTIMATE`.

    Its changes of mode and its refusals are not part of a row.
    """
    state, sample = estimate.state, estimate.state.sample
    write_estimate(
        row,
        sample.stamp_s,
        sample.since_last_s,
        sample.rate,
        sample.force,
        state.R_map_imu,
        state.p_map_imu,
        state.v_map_imu,
        state.gyro_bias,
        state.accel_bias,
        estimate.covariance,
        MODES.index(estimate.mode),
    )


def unpacked(row: Block) -> tuple[InertialState, Float]:
    """Return copies of the state and covariance (15, 15) of a row, shape (1,), dtype `ESTIMATE`."""
    one = row[0]
    names = ("R", "p", "v", "gyro_bias", "accel_bias")
    return InertialState(sample_of(one["sample"]), *(one[name].copy() for name in names)), one[
        "P"
    ].copy()


def is_finite(row: Block) -> bool:
    """Return whether all values of an estimate are finite, shape (1,), dtype `ESTIMATE`."""
    return bool(has_finite_values(row))
