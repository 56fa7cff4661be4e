"""Plugins that plan where and how to set stones down."""
