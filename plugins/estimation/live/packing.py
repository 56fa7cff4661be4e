"""Samples and estimates in the block that the inertial path shares with the smoother, and out of
it.
"""

import numpy as np
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.kernels import Block
from executive_plugins.estimation.live.layout import ESTIMATE, SAMPLES
from executive_plugins.estimation.live.modes import Mode

from executive.arrays import Float

MODES = tuple(Mode)


def samples_from(block: Block, first: int, end: int) -> list[Inertial]:
    """Return copies of the samples of some numbers, of those that the block still holds.

    Args:
        block: Shape (1,), dtype `LIVE`.
        first: Number of the first sample, counted from 0.
        end: Number after the last.
    """
    kept = np.arange(max(first, end - SAMPLES, 0), end) % SAMPLES
    return [sample_of(row) for row in block["samples"][0][kept]]


def sample_of(row: Block) -> Inertial:
    """Return the sample of a row, dtype `SAMPLE`, which is copied."""
    return Inertial(
        float(row["stamp_s"]), row["rate"].copy(), row["force"].copy(), float(row["since_last_s"])
    )


def packed(state: InertialState, covariance: Float) -> Block:
    """Return a state with its covariance (15, 15) as an estimate of the mode GLOBAL, shape (1,),
    dtype `ESTIMATE`.
    """
    return packed_estimate(Estimate(state, covariance, Mode.GLOBAL, (), {}))


def packed_estimate(estimate: Estimate) -> Block:
    """Return an estimate without its messages, shape (1,), dtype `ESTIMATE`."""
    row = np.zeros(1, ESTIMATE)
    pack_into(row, estimate)
    return row


def pack_into(row: Block, estimate: Estimate) -> None:
    """Write an estimate into a row, shape (1,), dtype `ESTIMATE`; its changes and refusals do not
    fit.
    """
    state, to = estimate.state, row[0]
    sample = to["sample"]
    sample["stamp_s"], sample["since_last_s"] = state.sample.stamp_s, state.sample.since_last_s
    sample["rate"], sample["force"] = state.sample.rate, state.sample.force
    to["R"], to["p"], to["v"] = state.R_map_imu, state.p_map_imu, state.v_map_imu
    to["gyro_bias"], to["accel_bias"] = state.gyro_bias, state.accel_bias
    to["P"], to["mode"] = estimate.covariance, MODES.index(estimate.mode)


def unpacked(row: Block) -> tuple[InertialState, Float]:
    """Return copies of the state and the covariance (15, 15) of a row, shape (1,), dtype
    `ESTIMATE`.
    """
    one = row[0]
    names = ("R", "p", "v", "gyro_bias", "accel_bias")
    return InertialState(sample_of(one["sample"]), *(one[name].copy() for name in names)), one[
        "P"
    ].copy()


def is_finite(row: Block) -> bool:
    """Return whether an estimate, shape (1,), dtype `ESTIMATE`, holds numbers only."""
    return all(
        bool(np.isfinite(row[name]).all())
        for name in ("R", "p", "v", "gyro_bias", "accel_bias", "P")
    )
