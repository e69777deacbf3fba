"""Measured or simulated fibres as curves on the belt: points, angles, curvatures."""
