"""What the benchmarks run; each command imports it after reading its command line."""
