"""The metrics of missions; each has one definition, shown on docs/metrics.md."""
