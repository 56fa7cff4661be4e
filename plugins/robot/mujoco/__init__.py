"""The simulated robot: MuJoCo physics, ray-cast lidars, noisy sensors."""
