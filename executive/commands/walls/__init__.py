"""The verb that builds structures of found stones in a trial: the planner alone, no machine."""
