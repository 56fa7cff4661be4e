"""Plugins that watch a held stone."""
