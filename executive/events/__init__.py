"""Events of a mission: a frozen class each, written to the journal and read back as that class."""
