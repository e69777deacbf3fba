"""Whether a density and paths have the same law."""
