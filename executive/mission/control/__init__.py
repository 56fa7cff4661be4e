"""What people ask of a mission over its control socket."""
