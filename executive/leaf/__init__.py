"""The parts of leaves: ports, typed access to plugins, jobs, and steps that leaves share."""
