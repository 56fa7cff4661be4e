"""The words of the mission language, described: nodes, modifiers, leaves."""
