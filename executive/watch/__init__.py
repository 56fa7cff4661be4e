"""What is watched while a mission runs: streams of observations, the estimate, and the motion."""
