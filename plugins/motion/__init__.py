"""Plugins that plan motions of the arm."""
