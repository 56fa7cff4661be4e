"""A mission without its machine: leaves are mocked, and no time is waited for."""
