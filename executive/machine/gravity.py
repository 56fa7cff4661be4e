"""Standard gravity, rounded to what the simulated world and the load estimates use."""

GRAVITY_M_S2 = 9.81
