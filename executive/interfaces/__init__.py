"""What a plugin author reads: one abstract class a capability, values in, values out."""
