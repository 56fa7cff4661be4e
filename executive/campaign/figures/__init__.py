"""From runs to figures: metrics, rates, intervals, paired differences, bounds."""
