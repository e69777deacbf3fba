"""The compiled kernels of the grid solver, and what a call of one leaves."""

import numpy as np
from numba.core.dispatcher import Dispatcher

from fpsolve._kernels import (
    characteristics,
    combining,
    fourier_shift,
    functionals,
    moebius,
    rotation,
    smooth,
    translation,
    tridiagonal,
)
from fpsolve._kernels.compiling import ParallelKernel

MODULES = [
    characteristics, combining, fourier_shift, functionals, moebius, rotation, smooth,
    translation, tridiagonal,
]  # fmt: skip


KERNELS = {
    name: function
    for module in MODULES
    for name, function in vars(module).items()
    if isinstance(function, Dispatcher | ParallelKernel)
}


def called(function, arguments):
    """What a call returns and leaves in its array arguments."""
    mine = [np.copy(a) if isinstance(a, np.ndarray) else a for a in arguments]
    result = function(*mine)
    returned = [] if result is None else np.atleast_1d(result)
    return [*returned, *(a for a in mine if isinstance(a, np.ndarray))]


PARALLEL = [
    name for name, kernel in KERNELS.items() if isinstance(kernel, ParallelKernel)
]
