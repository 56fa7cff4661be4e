"""Plugins that plan grasps."""
