"""Four neighbouring values of an array, held and combined in registers.

The compiler turns a loop over neighbouring values into vector instructions only where
it can prove that no array written overlaps one read, which it cannot for more than a
handful of arrays. Inner loops that combine many rows therefore say it themselves:
`take` reads four values, `put` writes them, `+ - * /` act on all four. Outside
compiled code the same functions act on numpy arrays of four values.

`a * b + c` is rounded once. Where two products meet, as in `a * b + c * d`, a compiler
chooses which of them is rounded, and chooses differently for a kernel that has just
been compiled and for the same one read from numba's cache: `fused` leaves no choice.

Numba's cache of a kernel does not see this file: clear it after a change here.
"""

import operator

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, models, overload, register_model

LANES = 4
VECTOR = ir.VectorType(ir.DoubleType(), LANES)
BITS = ir.VectorType(ir.IntType(64), LANES)
ROOT_HALF = 0x3FE6A09E667F3BCD
BITS_OF_2_52 = 0x4330000000000000


class LanesType(types.Type):
    """Numba's type of four float64 in a register."""

    def __init__(self):
        super().__init__(name="Lanes")


lanes_type = LanesType()


@register_model(LanesType)
class LanesModel(models.PrimitiveModel):
    """Lanes are an LLVM vector."""

    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, VECTOR)


def take(array, index):
    """The values array[..., k], …, array[..., k + 3] for index = (..., k)."""
    return array[(*index[:-1], slice(index[-1], index[-1] + LANES))]


def put(array, index, lanes):
    """Write lanes to array[..., k], …, array[..., k + 3] for index = (..., k)."""
    array[(*index[:-1], slice(index[-1], index[-1] + LANES))] = lanes


def spread(value):
    """Four times the same value."""
    return np.full(LANES, value)


def transposed(a, b, c, d):
    """The columns of the matrix with the rows a, b, c, d."""
    return tuple(np.array([a, b, c, d]).T)


def smaller(one, other):
    """The smaller of two, lane by lane; NaN in the first stays."""
    return np.where(one > other, other, one)


def larger(one, other):
    """The larger of two, lane by lane; NaN in the first stays."""
    return np.where(one < other, other, one)


def mantissa_and_exponent(lanes):
    """m in [√½, √2) and whole e with 2^e m the positive normal numbers given."""
    mantissa, exponent = np.frexp(lanes)
    low = mantissa < np.sqrt(0.5)
    return np.where(low, 2.0 * mantissa, mantissa), exponent - 1.0 * low


def fused(a, b, c):
    """A b + c, rounded once; twice outside compiled code."""
    return a * b + c


def root(lanes):
    """Square roots."""
    return np.sqrt(lanes)


def below(lanes):
    """The largest whole numbers that are not above."""
    return np.floor(lanes)


def parts(lanes):
    """The four values as numbers."""
    return tuple(lanes)


def pointer_to(context, builder, signature, arguments):
    """Address of array[index] as that of four values."""
    array_type, index_type = signature.args[:2]
    array = context.make_array(array_type)(context, builder, arguments[0])
    parts = cgutils.unpack_tuple(builder, arguments[1], len(index_type))
    index = [
        context.cast(builder, part, kind, types.intp)
        for part, kind in zip(parts, index_type, strict=True)
    ]
    item = cgutils.get_item_pointer(
        context, builder, array_type, array, index, wraparound=False
    )
    return builder.bitcast(item, VECTOR.as_pointer())


@intrinsic
def lanes_at(_, array, index):
    """`take` in compiled code."""

    def code(context, builder, signature, arguments):
        pointer = pointer_to(context, builder, signature, arguments)
        return builder.load(pointer, align=8)

    return lanes_type(array, index), code


@intrinsic
def set_lanes(_, array, index, lanes):
    """`put` in compiled code."""

    def code(context, builder, signature, arguments):
        pointer = pointer_to(context, builder, signature, arguments)
        builder.store(arguments[2], pointer, align=8)
        return context.get_dummy_value()

    return types.none(array, index, lanes), code


def shuffled(builder, one, other, places):
    """Four of the eight values of two vectors."""
    pattern = ir.Constant(ir.VectorType(ir.IntType(32), LANES), list(places))
    return builder.shuffle_vector(one, other, pattern)


@intrinsic
def all_lanes(_, value):
    """`spread` in compiled code."""

    def code(context, builder, signature, arguments):
        number = context.cast(builder, arguments[0], signature.args[0], types.float64)
        undefined = ir.Constant(VECTOR, ir.Undefined)
        first = builder.insert_element(undefined, number, ir.IntType(32)(0))
        return shuffled(builder, first, first, (0, 0, 0, 0))

    return lanes_type(value), code


@intrinsic
def transposed_lanes(_, a, b, c, d):
    """`transposed` in compiled code."""

    def code(context, builder, signature, rows):
        columns = []
        for places in ((0, 4, 1, 5), (2, 6, 3, 7)):
            upper = shuffled(builder, rows[0], rows[1], places)
            lower = shuffled(builder, rows[2], rows[3], places)
            columns.append(shuffled(builder, upper, lower, (0, 1, 4, 5)))
            columns.append(shuffled(builder, upper, lower, (2, 3, 6, 7)))
        return context.make_tuple(builder, signature.return_type, columns)

    return types.UniTuple(lanes_type, LANES)(a, b, c, d), code


def choice(comparison):
    """Intrinsic that takes the second where `first comparison second` holds."""

    @intrinsic
    def choose(_, one, other):
        def code(context, builder, signature, arguments):
            one, other = arguments
            second = builder.fcmp_ordered(comparison, one, other)
            return builder.select(second, other, one)

        return lanes_type(one, other), code

    return choose


smaller_lanes, larger_lanes = choice(">"), choice("<")


def whole_numbers(value):
    """Four times the same 64-bit pattern."""
    return ir.Constant(BITS, [value] * LANES)


@intrinsic
def split_lanes(_, lanes):
    """`mantissa_and_exponent` in compiled code, by integer operations on the bits."""

    def code(context, builder, signature, arguments):
        bits = builder.bitcast(arguments[0], BITS)
        # √½ has the bits ROOT_HALF and 1 the bits 1023 << 52: with this added, the
        # exponent field of [√½, √2) reads 1023.
        moved = builder.add(bits, whole_numbers((1023 << 52) - ROOT_HALF))
        field = builder.lshr(moved, whole_numbers(52))
        away = builder.shl(builder.sub(field, whole_numbers(1023)), whole_numbers(52))
        mantissa = builder.bitcast(builder.sub(bits, away), VECTOR)
        # A whole number n below 2⁵² put into the last bits of 2⁵² makes 2⁵² + n.
        number = builder.or_(field, whole_numbers(BITS_OF_2_52))
        offset = ir.Constant(VECTOR, [2.0**52 + 1023.0] * LANES)
        exponent = builder.fsub(builder.bitcast(number, VECTOR), offset)
        return context.make_tuple(builder, signature.return_type, [mantissa, exponent])

    return types.UniTuple(lanes_type, 2)(lanes), code


def vector_function(builder, name, n_arguments):
    """LLVM's function of that name for vectors."""
    kind = ir.FunctionType(VECTOR, [VECTOR] * n_arguments)
    name = f"llvm.{name}.v{LANES}f64"
    return cgutils.get_or_insert_function(builder.module, kind, name)


@intrinsic
def root_lanes(_, lanes):
    """`root` in compiled code."""

    def code(context, builder, signature, arguments):
        return builder.call(vector_function(builder, "sqrt", 1), arguments)

    return lanes_type(lanes), code


@intrinsic
def floor_of_lanes(_, lanes):
    """`below` in compiled code."""

    def code(context, builder, signature, arguments):
        return builder.call(vector_function(builder, "floor", 1), arguments)

    return lanes_type(lanes), code


@intrinsic
def fused_lanes(_, a, b, c):
    """`fused` in compiled code."""

    def code(context, builder, signature, arguments):
        return builder.call(vector_function(builder, "fma", 3), arguments)

    return lanes_type(a, b, c), code


@intrinsic
def opposite_lanes(_, lanes):
    """−lanes in compiled code."""

    def code(context, builder, signature, arguments):
        return builder.fneg(arguments[0])

    return lanes_type(lanes), code


@intrinsic
def parts_of_lanes(_, lanes):
    """`parts` in compiled code."""

    def code(context, builder, signature, arguments):
        values = [
            builder.extract_element(arguments[0], ir.IntType(32)(lane))
            for lane in range(LANES)
        ]
        return context.make_tuple(builder, signature.return_type, values)

    return types.UniTuple(types.float64, LANES)(lanes), code


def lane_by_lane(instruction):
    """Intrinsic of an instruction on two vectors; contraction is allowed."""

    @intrinsic
    def combine(_, one, other):
        def code(context, builder, signature, arguments):
            return getattr(builder, instruction)(*arguments, flags=("contract",))

        return lanes_type(one, other), code

    return combine


added, subtracted = lane_by_lane("fadd"), lane_by_lane("fsub")
multiplied, divided = lane_by_lane("fmul"), lane_by_lane("fdiv")


@overload(take, inline="always")
def compiled_take(array, index):
    """Implementation for numba."""
    return lambda array, index: lanes_at(array, index)


@overload(put, inline="always")
def compiled_put(array, index, lanes):
    """Implementation for numba."""
    return lambda array, index, lanes: set_lanes(array, index, lanes)


@overload(spread, inline="always")
def compiled_spread(value):
    """Implementation for numba."""
    return lambda value: all_lanes(value)


@overload(transposed, inline="always")
def compiled_transposed(a, b, c, d):
    """Implementation for numba."""
    return lambda a, b, c, d: transposed_lanes(a, b, c, d)


@overload(smaller, inline="always")
def compiled_smaller(one, other):
    """Implementation for numba."""
    return lambda one, other: smaller_lanes(one, other)


@overload(larger, inline="always")
def compiled_larger(one, other):
    """Implementation for numba."""
    return lambda one, other: larger_lanes(one, other)


@overload(mantissa_and_exponent, inline="always")
def compiled_mantissa_and_exponent(lanes):
    """Implementation for numba."""
    return lambda lanes: split_lanes(lanes)


@overload(root, inline="always")
def compiled_root(lanes):
    """Implementation for numba."""
    return lambda lanes: root_lanes(lanes)


@overload(below, inline="always")
def compiled_below(lanes):
    """Implementation for numba."""
    return lambda lanes: floor_of_lanes(lanes)


@overload(fused, inline="always")
def compiled_fused(a, b, c):
    """Implementation for numba."""
    return lambda a, b, c: fused_lanes(a, b, c)


@overload(parts, inline="always")
def compiled_parts(lanes):
    """Implementation for numba."""
    return lambda lanes: parts_of_lanes(lanes)


@overload(operator.neg, inline="always")
def compiled_opposite(lanes):
    """−lanes."""
    if lanes == lanes_type:
        return lambda lanes: opposite_lanes(lanes)
    return None


@overload(operator.add, inline="always")
def compiled_add(one, other):
    """one + other, lane by lane."""
    if one == other == lanes_type:
        return lambda one, other: added(one, other)
    return None


@overload(operator.sub, inline="always")
def compiled_subtract(one, other):
    """one − other, lane by lane."""
    if one == other == lanes_type:
        return lambda one, other: subtracted(one, other)
    return None


@overload(operator.mul, inline="always")
def compiled_multiply(one, other):
    """one · other, lane by lane."""
    if one == other == lanes_type:
        return lambda one, other: multiplied(one, other)
    return None


@overload(operator.truediv, inline="always")
def compiled_divide(one, other):
    """one / other, lane by lane."""
    if one == other == lanes_type:
        return lambda one, other: divided(one, other)
    return None
