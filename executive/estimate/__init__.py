"""Estimators on recorded logs: replay, measures, files."""
