"""Campaigns: many runs with their limits, results, statistics and report."""
