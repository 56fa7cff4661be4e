"""Small faults that are planted in copies of the tree, to see whether a test notices them."""
