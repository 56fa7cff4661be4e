"""Labels for the classifier from simulated lifts, and its training."""
