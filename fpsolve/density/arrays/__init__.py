"""`drift_kick` as an array program: on the arrays of whichever library p0 is one of."""
