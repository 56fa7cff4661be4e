"""Faults on purpose, in front of any robot and any plugin: what a mission is tried against."""
