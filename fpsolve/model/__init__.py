"""The continuous problem: potential, reference curve, noise; from a process in SI units."""
