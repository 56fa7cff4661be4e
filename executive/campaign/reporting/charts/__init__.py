"""Charts as Vega-Lite specifications with their data aggregated."""
