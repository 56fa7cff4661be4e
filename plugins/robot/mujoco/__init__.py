"""The simulated world: MuJoCo physics, ray-cast lidars, noisy sensors."""
