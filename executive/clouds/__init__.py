"""Point clouds as files that users have."""
