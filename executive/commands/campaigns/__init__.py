"""Verbs for many missions, and for the reports of one and of many."""
