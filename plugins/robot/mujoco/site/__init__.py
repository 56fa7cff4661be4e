"""The simulated site: ground, stones, their surfaces for rays, and photographs of them."""
