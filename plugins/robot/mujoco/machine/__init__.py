"""The drives of the simulated machine: position servos of the arm, and the drive of the jaws."""
