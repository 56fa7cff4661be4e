"""What the inertial path keeps, in one block of memory, so that a sample is one call of compiled
code.

The block may be shared with the smoother's process: samples go there and estimates come back
without a system call.
"""

import numpy as np

SAMPLE = np.dtype(
    [("stamp_s", "f8"), ("since_last_s", "f8"), ("rate", "f8", (3,)), ("force", "f8", (3,))]
)
"""An inertial sample, see `inertial_state.Inertial`."""

ESTIMATE = np.dtype(
    [
        ("sample", SAMPLE),
        ("R", "f8", (3, 3)),
        ("p", "f8", (3,)),
        ("v", "f8", (3,)),
        ("gyro_bias", "f8", (3,)),
        ("accel_bias", "f8", (3,)),
        ("P", "f8", (15, 15)),
        ("mode", "i8"),
        ("epoch", "i8"),  # which beginning it goes back to
        ("messages", "i8"),  # how many messages of changes and refusals have been sent until then
    ]
)
"""A state of the inertial sensor with its covariance, and how the estimator stands."""

SAMPLES, ANSWERS = 4096, 8  # ten seconds at 400 Hz; estimates that may be written while one is read

LIVE = np.dtype(
    [
        # the state at the newest sample
        ("stamp_s", "f8"),
        ("rate", "f8", (3,)),
        ("R", "f8", (3, 3)),
        ("p", "f8", (3,)),
        ("v", "f8", (3,)),
        ("gyro_bias", "f8", (3,)),
        ("accel_bias", "f8", (3,)),
        # what was estimated last, from which the covariance is carried on: rate and force without
        # their biases
        ("from_s", "f8"),
        ("from_R", "f8", (3, 3)),
        ("from_rate", "f8", (3,)),
        ("from_force", "f8", (3,)),
        ("from_P", "f8", (15, 15)),
        ("carried_s", "f8"),
        ("P", "f8", (15, 15)),
        ("covariance", "f8", (6, 6)),
        # what stays, and the turn joint
        ("gravity_m_s2", "f8"),
        ("gap_s", "f8"),
        ("densities", "f8", (4,)),
        ("T_imu_cabin", "f8", (4, 4)),
        ("T_joint_base", "f8", (4, 4)),
        ("axis", "f8", (3,)),
        ("turn_s", "f8"),
        ("turn_rad", "f8"),
        ("turn_rad_s", "f8"),
        ("T_odom_map", "f8", (4, 4)),
        # scratch
        ("half_turn", "f8", (3, 3)),
        ("R_middle", "f8", (3, 3)),
        ("T_map_imu", "f8", (4, 4)),
        ("T_cabin_base", "f8", (4, 4)),
        ("T_before", "f8", (4, 4)),
        # what crosses to the smoother's process and back
        ("written", "i8"),  # samples that are there
        (
            "forgotten",
            "i8",
        ),  # samples that no estimate is carried on through: of before a new beginning
        ("published", "i8"),  # samples that the other side may read
        ("handled", "i8"),  # batches that the other side has worked through
        ("answered", "i8"),  # estimates that this side may read
        ("epoch", "i8"),  # of which beginning they must be
        ("samples", SAMPLE, (SAMPLES,)),
        ("answers", ESTIMATE, (ANSWERS,)),
    ],
    align=True,
)
