"""Many cases in several processes, kept as they are done."""
