"""Machines as data: a folder each, with robot.yaml as the single source."""
