"""The simulated sensors: lidars, inertial units, GNSS antennas and joint encoders."""
