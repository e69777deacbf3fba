"""A model by its numbers, and webs of few wave vectors."""

import numpy as np

import fpsolve as fp
from fpsolve.spectral.resolvent import smooth_ladder
from fpsolve.spectral.resolvent.fibre import SmoothFibre
from fpsolve.web.table import N_NODES

# Noise, belt speed, σ1, σ2, spacing.
NUMBERS = np.array([2.0, 0.2, 1.0, 0.8, 1.5])


def model_of(numbers):
    """The model of noise, belt speed, σ1 and σ2."""
    noise, speed, sigma1, sigma2 = numbers[:4]
    potential = fp.QuadraticPotential(sigma1, sigma2)
    return fp.LayDownModel(potential, noise, fp.MovingBelt(speed))


def choose_few_nodes(monkeypatch):
    """For laws that hold between any nodes."""
    for axis, n in (("along", 3), ("across", 5), ("shortness", 3), ("direction", 3)):
        monkeypatch.setitem(N_NODES, axis, n)


def choose_one_truncation(monkeypatch, degree=6, harmonics=4):
    """Of smooth fibres the smallest one, for what a truncation knows to a per cent."""
    monkeypatch.setattr(smooth_ladder, "DEGREE", degree)
    monkeypatch.setattr(smooth_ladder, "HARMONICS", harmonics)

    def climb(self, first, compute, allowed, level=0, most=None, unseen=None):
        found = compute(self.generator(first))
        return found, np.zeros_like(found), 0

    monkeypatch.setattr(SmoothFibre, "climb", climb)
