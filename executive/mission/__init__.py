"""A mission as it runs: plugins assembled, the tick loop, jobs, the safe stop, the report."""
