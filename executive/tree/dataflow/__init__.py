"""The types that keys hold along the order of execution, and the mistakes that they show."""
