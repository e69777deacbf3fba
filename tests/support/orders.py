"""One routine that measures an order of convergence, at every halving."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Convergence:
    """Errors at resolutions n, 2n, 4n, … and the order at every halving."""

    resolutions: tuple
    errors: np.ndarray

    @property
    def orders(self):
        return np.log2(self.errors[:-1] / self.errors[1:])

    def __str__(self):
        errors = ", ".join(f"{error:.3g}" for error in self.errors)
        orders = ", ".join(f"{order:.2f}" for order in self.orders)
        return f"errors {errors} at {self.resolutions}: orders {orders}"


def measure_order(error_of, first, n_halvings=2):
    """Errors error_of(n) for n = first, 2·first, …: steps of a run, or cells."""
    resolutions = tuple(first * 2**halving for halving in range(n_halvings + 1))
    return Convergence(resolutions, np.array([error_of(n) for n in resolutions]))


def assert_order(convergence, declared, ceiling, band=0.3):
    """The declared order at every halving, and a finest error below the ceiling.

    The band of 0.3 is what the next term of the error's expansion leaves at the
    coarsest resolutions used here (it shrinks at every halving); it is less than half
    the distance to the next order, so no other integer order passes. The ceiling, a
    few times what was measured, catches a scheme of the right order that has become
    worse.
    """
    deviations = np.abs(convergence.orders - declared)
    assert deviations.max() <= band, f"declared {declared}, {convergence}"
    assert convergence.errors[-1] <= ceiling, f"ceiling {ceiling:g}, {convergence}"
