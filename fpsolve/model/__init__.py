"""The continuous problem: potential, reference curve, noise; a process in SI units."""
