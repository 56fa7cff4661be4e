"""objects plugins."""
