"""segmentation plugins."""
