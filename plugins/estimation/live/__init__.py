"""The estimate at the newest inertial sample: the smoothed state, propagated in compiled code."""
