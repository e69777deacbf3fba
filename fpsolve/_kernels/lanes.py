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
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin, models, register_model

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


def compiled(function, result, *kinds):
    """Let compiled code make of `function(*kinds)`, which is a `result`, what follows.

    Decorates code(context, builder, signature, arguments), which gives LLVM's value.
    Said to numba directly: an `overload` would be one more function for every kind of
    array and index, typed and put into its caller at every call, which took longer than
    all that LLVM does with a kernel.
    """

    def register(code):
        infer_global(function)(call_of(kinds, result))
        lower_builtin(function, *kinds)(code)
        return code

    return register


def call_of(kinds, result):
    """Numba's template of a call with arguments of these kinds: types or classes."""

    class Call(AbstractTemplate):
        def generic(self, arguments, keywords):
            if keywords or len(arguments) != len(kinds):
                return None
            if all(map(is_of, arguments, kinds)):
                return signature(result, *arguments)
            return None

    return Call


def is_of(argument, kind):
    """Whether numba's type of an argument is this type, or of this class."""
    return isinstance(argument, kind) if isinstance(kind, type) else argument == kind


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


def shuffled(builder, one, other, places):
    """Four of the eight values of two vectors."""
    pattern = ir.Constant(ir.VectorType(ir.IntType(32), LANES), list(places))
    return builder.shuffle_vector(one, other, pattern)


def whole_numbers(value):
    """Four times the same 64-bit pattern."""
    return ir.Constant(BITS, [value] * LANES)


def vector_function(builder, name, arguments):
    """LLVM's function of that name for vectors."""
    kind = ir.FunctionType(VECTOR, [VECTOR] * len(arguments))
    name = f"llvm.{name}.v{LANES}f64"
    function = cgutils.get_or_insert_function(builder.module, kind, name)
    return builder.call(function, arguments)


@compiled(take, lanes_type, types.Array, types.BaseTuple)
def compiled_take(context, builder, signature, arguments):
    """Load of four values."""
    return builder.load(pointer_to(context, builder, signature, arguments), align=8)


@compiled(put, types.none, types.Array, types.BaseTuple, lanes_type)
def compiled_put(context, builder, signature, arguments):
    """Store of four values."""
    pointer = pointer_to(context, builder, signature, arguments)
    builder.store(arguments[2], pointer, align=8)
    return context.get_dummy_value()


@compiled(spread, lanes_type, types.Number)
def compiled_spread(context, builder, signature, arguments):
    """One value, taken four times."""
    number = context.cast(builder, arguments[0], signature.args[0], types.float64)
    undefined = ir.Constant(VECTOR, ir.Undefined)
    first = builder.insert_element(undefined, number, ir.IntType(32)(0))
    return shuffled(builder, first, first, (0, 0, 0, 0))


@compiled(transposed, types.UniTuple(lanes_type, LANES), *[lanes_type] * LANES)
def compiled_transposed(context, builder, signature, rows):
    """Pairs first, then their halves."""
    columns = []
    for places in ((0, 4, 1, 5), (2, 6, 3, 7)):
        upper = shuffled(builder, rows[0], rows[1], places)
        lower = shuffled(builder, rows[2], rows[3], places)
        columns.append(shuffled(builder, upper, lower, (0, 1, 4, 5)))
        columns.append(shuffled(builder, upper, lower, (2, 3, 6, 7)))
    return context.make_tuple(builder, signature.return_type, columns)


@compiled(mantissa_and_exponent, types.UniTuple(lanes_type, 2), lanes_type)
def compiled_mantissa_and_exponent(context, builder, signature, arguments):
    """By integer operations on the bits."""
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


@compiled(parts, types.UniTuple(types.float64, LANES), lanes_type)
def compiled_parts(context, builder, signature, arguments):
    """The elements of the vector."""
    values = [
        builder.extract_element(arguments[0], ir.IntType(32)(lane))
        for lane in range(LANES)
    ]
    return context.make_tuple(builder, signature.return_type, values)


@compiled(root, lanes_type, lanes_type)
def compiled_root(context, builder, signature, arguments):
    """Correctly rounded."""
    return vector_function(builder, "sqrt", arguments)


@compiled(below, lanes_type, lanes_type)
def compiled_below(context, builder, signature, arguments):
    """Exact."""
    return vector_function(builder, "floor", arguments)


@compiled(fused, lanes_type, lanes_type, lanes_type, lanes_type)
def compiled_fused(context, builder, signature, arguments):
    """Rounded once."""
    return vector_function(builder, "fma", arguments)


@compiled(operator.neg, lanes_type, lanes_type)
def compiled_opposite(context, builder, signature, arguments):
    """−lanes."""
    return builder.fneg(arguments[0])


def choose(function, comparison):
    """Compile `function` to the second where `first comparison second` holds."""

    @compiled(function, lanes_type, lanes_type, lanes_type)
    def choice(context, builder, signature, arguments):
        one, other = arguments
        second = builder.fcmp_ordered(comparison, one, other)
        return builder.select(second, other, one)


def lane_by_lane(function, instruction):
    """Compile `function` to an instruction on two vectors; contraction is allowed."""

    @compiled(function, lanes_type, lanes_type, lanes_type)
    def combination(context, builder, signature, arguments):
        return getattr(builder, instruction)(*arguments, flags=("contract",))


choose(smaller, ">")
choose(larger, "<")
lane_by_lane(operator.add, "fadd")
lane_by_lane(operator.sub, "fsub")
lane_by_lane(operator.mul, "fmul")
lane_by_lane(operator.truediv, "fdiv")
