"""Runs that survive a kill: what they need to go on lies on the disk."""

from fpsolve.checkpoints.checkpoint import Checkpoint

__all__ = ["Checkpoint"]
