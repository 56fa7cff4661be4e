"""Missions run once and recorded, for estimators to be compared on."""
