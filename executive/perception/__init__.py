"""Segmentation and registration of clouds from files, without a mission."""
