"""Bits of a number as a whole number and back, in compiled code without a detour.

Read through a view of an array, as numpy does it, the compiler does not see which
values are meant, and turns no loop that does so into vector instructions. Numba's cache
of a kernel does not see this file: clear it after a change here.
"""

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload


def bits_of(number):
    """The 64 bits of a number."""
    return int(np.float64(number).view(np.int64))


def number_of(bits):
    """The number with these 64 bits."""
    return float(np.int64(bits).view(np.float64))


@intrinsic
def bits_of_float(_, number):
    """`bits_of` in compiled code."""

    def code(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.IntType(64))

    return types.int64(types.float64), code


@intrinsic
def float_of_bits(_, bits):
    """`number_of` in compiled code."""

    def code(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.DoubleType())

    return types.float64(types.int64), code


@overload(bits_of, inline="always")
def compiled_bits_of(number):
    """Implementation for numba."""
    return lambda number: bits_of_float(number)


@overload(number_of, inline="always")
def compiled_number_of(bits):
    """Implementation for numba."""
    return lambda bits: float_of_bits(bits)
