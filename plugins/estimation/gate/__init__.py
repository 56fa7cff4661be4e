"""Which measurements an estimator takes: order in time, and tests of position fixes."""
