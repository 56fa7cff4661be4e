"""The command line: one verb a file, and one way to read options, to answer and to refuse."""
