"""Processes of runs: forked after the imports, held to limits, ended with all that descends."""
