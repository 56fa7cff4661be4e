"""The checks, as pytest runs them: those of every plugin, and those of one capability each."""
