"""Derivatives on a grid of the phase space of functions that end in its box."""

import numpy as np


def derivative(values, grid, axis, order=1):
    """Along an axis of a SmoothPhaseSpaceGrid, spectrally."""
    n, step = grid.shape[axis], grid.spacing[axis]
    frequency = 2 * np.pi * np.fft.fftfreq(n, step)
    frequency[n // 2] = 0.0
    shape = [1, 1, 1, 1]
    shape[axis] = n
    factor = ((1j * frequency) ** order).reshape(shape)
    return np.fft.ifft(factor * np.fft.fft(values, axis=axis), axis=axis)
