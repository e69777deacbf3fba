"""The grid solver: schemes, runs, what they leave, checkpoints, stationary states."""
