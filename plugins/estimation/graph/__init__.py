"""Factor graphs: the dual graph of Nubert et al. 2022, and the batch solution of a whole log."""
