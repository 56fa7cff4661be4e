"""The estimate of this moment: the smoothed state, propagated by compiled inertial steps."""
