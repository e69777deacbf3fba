"""The scheme for smooth fibres, equation (23): its operators and how they compose."""

from fpsolve.density.smooth.smooth_drift_kick import SmoothDriftKick

__all__ = ["SmoothDriftKick", "smooth_drift_kick"]

smooth_drift_kick = SmoothDriftKick
