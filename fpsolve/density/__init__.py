"""The grid solver: schemes, runs and what they leave, checkpoints, stationary densities."""
