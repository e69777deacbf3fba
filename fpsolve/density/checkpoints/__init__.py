"""Runs that survive a kill: what they need to go on lies on the disk."""

from fpsolve.density.checkpoints.checkpoint import Checkpoint

__all__ = ["Checkpoint"]
