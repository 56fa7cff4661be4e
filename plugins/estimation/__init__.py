"""estimation plugins."""
