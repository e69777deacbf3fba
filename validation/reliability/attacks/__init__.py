"""Random combinations of arguments, and independent values to compare with."""
