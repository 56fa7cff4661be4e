"""The supervisor: a process beside the executive that can stop the machine without it."""
