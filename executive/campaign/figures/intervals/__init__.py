"""Confidence intervals of 95 %: of shares, of quantiles, of paired differences."""
