"""Machine code is made of a whole kernel, not of the parts it is linked from as well.

Of a loop over threads numba makes a function, of this one that takes its arguments from
pointers, and of that one that starts threads; each is linked into the next and all into
the kernel, and each is optimised and translated for itself with all that is linked into
it, four times in all. Only what has come into the kernel ever runs. The parts are
therefore left as they are until the kernel is optimised, with them inside. The same
goes for numba's own functions, such as `np.empty` for one kind of shape.
"""

from contextlib import contextmanager
from functools import wraps

from llvmlite import ir
from llvmlite.binding import parse_assembly
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler_lock import global_compiler_lock

__all__ = ["compile_once"]

# What the libraries of parts are called: the body of a loop, the two functions about
# it, and functions that numba's own functions make.
PARTS = (
    "__numba_parfor_gufunc",
    "<numba.np.ufunc.wrappers",
    "parallelgufuncwrapper",
    "<locals>",
)
# What is replaced of numba; where a version has something else, nothing is.
REPLACED = ("_optimize_final_module", "_finalize_final_module")
CALLED = ("_finalize_dynamic_globals", "_verify_declare_only_symbols")

# What is called from Python, whatever its name.
_kernels = set()


class PartOfKernel(JITCodeLibrary):
    """What is linked into a kernel and has no machine code of its own."""

    def _optimize_final_module(self):
        pass

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


def compile_once(compiled):
    """Let `compiled.compile` leave the parts of a kernel to the kernel."""
    compile_now = compiled.compile
    _kernels.add(compiled.py_func.__qualname__)
    if not all(hasattr(JITCodeLibrary, name) for name in REPLACED + CALLED):
        return

    @wraps(compile_now)
    def compile_whole(signature):
        with global_compiler_lock, parts_unfinished(compiled.targetctx.codegen()):
            return compile_now(signature)

    compiled.compile = compile_whole


@contextmanager
def parts_unfinished(codegen):
    """Let `codegen` make libraries of parts that are only linked."""
    if "create_library" in vars(codegen):
        yield
        return
    create, tell = codegen.create_library, codegen.set_env

    def create_library(name, **options):
        part = name not in _kernels and any(known in name for known in PARTS)
        return PartOfKernel(codegen, name) if part else create(name, **options)

    def set_env(name, environment):
        if not codegen._engine.is_symbol_defined(name):
            define(codegen, name)
        tell(name, environment)

    codegen.create_library, codegen.set_env = create_library, set_env
    try:
        yield
    finally:
        del codegen.create_library, codegen.set_env


def define(codegen, name):
    """Make the pointer to what numba keeps of a part (its environment).

    It would be in the part's machine code; what the part is linked into shares it.
    """
    module = codegen._create_empty_module(name)
    pointer = ir.IntType(8).as_pointer()
    variable = ir.GlobalVariable(module, pointer, name)
    variable.linkage = "common"
    variable.initializer = ir.Constant(pointer, None)
    codegen._engine.add_module(parse_assembly(str(module)))
    codegen._engine.finalize_object()
