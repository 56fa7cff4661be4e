"""The robot wire: how an executive, a supervisor and a machine in other processes speak."""
