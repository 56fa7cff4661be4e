"""Estimators on recorded logs: replay, measures, comparison and files."""
