"""Functions that a sweep calls in other processes."""

import os
import warnings

import numpy as np


def square(x):
    """A number, an array, a complex number, a text, and where they were computed."""
    return {
        "square": x * x,
        "powers": np.array([x, x**3]),
        "wave": np.exp(1j * x),
        "name": f"x = {x}",
        "process": os.getpid(),
    }


def fails_at_two(x):
    if x == 2:
        raise ValueError("`x` must not be 2.")
    return {"x": x}


def dies_at_two(x):
    if x == 2:
        os._exit(3)
    return {"x": x}


def warns(x):
    warnings.warn("the box is small", UserWarning, stacklevel=1)
    return {"x": x}


def interrupts_at_two(x):
    if x == 2:
        raise KeyboardInterrupt
    return {"x": x}


def counted(x, folder):
    """Leaves a file for every call."""
    with open(os.path.join(folder, f"call-{os.getpid()}-{x}"), "a") as file:
        file.write("called\n")
    if x == 2 and not os.path.exists(os.path.join(folder, "mended")):
        raise ValueError("broken")
    return {"x": x, "root": np.sqrt(np.arange(3.0) * x)}


def returns_objects(x):
    return {"x": object()}
