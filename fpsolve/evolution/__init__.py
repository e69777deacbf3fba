"""What every evolution in arclength has: steps, series, stored densities, rates."""
