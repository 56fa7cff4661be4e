"""The sections of a campaign's page, in the order in which they are read."""
