"""Memory layout of the inertial path: one block, so that a sample is one call of compiled code.

The block may be shared with the smoother's process. Samples and estimates are then exchanged
without a system call.
"""

import numpy as np

SAMPLE = np.dtype(
    [("stamp_s", "f8"), ("since_last_s", "f8"), ("rate", "f8", (3,)), ("force", "f8", (3,))]
)
"""An inertial sample, see `state.Inertial`."""

STATE = (
    ("sample", SAMPLE),
    ("R", "f8", (3, 3)),
    ("p", "f8", (3,)),
    ("v", "f8", (3,)),
    ("gyro_bias", "f8", (3,)),
    ("accel_bias", "f8", (3,)),
    ("P", "f8", (15, 15)),
)
"""Fields of a state, see `state.InertialState`, and of the covariance of its error."""

ESTIMATE = np.dtype(
    [
        *STATE,
        ("mode", "i8"),
        ("epoch", "i8"),  # number of the start that it belongs to
        ("messages", "i8"),  # messages of changes and refusals that were sent before it
    ]
)
"""A state of the inertial sensor with its covariance, and the mode of the estimator."""

SAMPLES = 4096  # ring of samples: ten seconds at 400 Hz
ANSWERS = 8  # ring of estimates, so that none is overwritten while it is read

LIVE = np.dtype(
    [
        # The state at the newest sample.
        ("stamp_s", "f8"),
        ("rate", "f8", (3,)),
        ("R", "f8", (3, 3)),
        ("p", "f8", (3,)),
        ("v", "f8", (3,)),
        ("gyro_bias", "f8", (3,)),
        ("accel_bias", "f8", (3,)),
        # The last estimate, from which the covariance is propagated; rate and force without biases.
        ("from_s", "f8"),
        ("from_R", "f8", (3, 3)),
        ("from_rate", "f8", (3,)),
        ("from_force", "f8", (3,)),
        ("from_P", "f8", (15, 15)),
        ("carried_s", "f8"),
        ("P", "f8", (15, 15)),
        ("map_covariance", "f8", (6, 6)),  # of rotation and position, map axes
        # Constants, and the turn joint.
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
        # Scratch memory.
        ("half_turn", "f8", (3, 3)),
        ("R_middle", "f8", (3, 3)),
        ("T_map_imu", "f8", (4, 4)),
        ("T_cabin_base", "f8", (4, 4)),
        ("T_before", "f8", (4, 4)),
        ("by_pose", "f8", (6, 6)),
        ("half", "f8", (6, 6)),
        # Exchange with the smoother's process.
        ("written", "i8"),  # number of samples that were written
        ("forgotten", "i8"),  # number of samples before a restart, which are not integrated
        ("published", "i8"),  # number of samples that the smoother's process may read
        ("handled", "i8"),  # number of batches that the smoother's process has handled
        ("answered", "i8"),  # number of estimates that the propagator may read
        ("epoch", "i8"),  # number of the start that estimates must belong to
        ("samples", SAMPLE, (SAMPLES,)),
        ("answers", ESTIMATE, (ANSWERS,)),
    ],
    align=True,
)
