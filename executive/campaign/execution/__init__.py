"""Trials in processes of their own, here or on a cluster, and the ledger of their results."""
