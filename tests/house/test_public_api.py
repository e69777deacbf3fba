"""The names a user sees, and what importing them costs."""

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import fpsolve as fp

PACKAGE = Path(fp.__file__).parent
HEAVY = ("numba", "scipy", "matplotlib", "xarray", "pandas", "typer", "pydantic", "pde")


@pytest.mark.parametrize("name", fp.__all__)
def test_every_public_name_exists_and_is_documented(name):
    value = getattr(fp, name)
    assert value.__doc__
    assert name in dir(fp)


def test_names_are_listed_in_order_and_once():
    assert fp.__all__ == sorted(set(fp.__all__))


def test_no_public_function_has_the_name_of_a_room():
    # Importing the room would put it in the place of the function.
    rooms = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    for name in rooms & set(fp.__all__):
        assert isinstance(getattr(fp, name), ModuleType)


def test_submodules_are_reached_as_attributes():
    for name in ("diagnostics", "initial", "plotting"):
        assert isinstance(getattr(fp, name), ModuleType)


def test_unknown_names_are_attribute_errors():
    with pytest.raises(AttributeError, match="has no attribute 'sovle'"):
        fp.sovle  # noqa: B018


def test_the_version_is_that_of_the_distribution_when_installed():
    from importlib.metadata import PackageNotFoundError, version

    try:
        expected = version("fpsolve")
    except PackageNotFoundError:
        # Run from a checkout that is not installed.
        with pytest.raises(PackageNotFoundError):
            fp.__version__  # noqa: B018
        return
    assert fp.__version__ == expected


def test_import_loads_nothing_heavy():
    loaded = run(
        "import fpsolve.studies, sys; "
        f"print([m for m in {('numpy', *HEAVY)!r} if m in sys.modules])"
    )
    assert loaded.strip() == "[]"


@pytest.mark.parametrize(
    ("statement", "unwanted"),
    [
        # The continuous model needs no compiler, and nothing needs pictures.
        ("fp.LayDownModel(fp.QuadraticPotential(), 1.0)", ("numba", "matplotlib")),
        (
            "fp.solve, fp.drift_kick, fp.PhaseSpaceGrid",
            ("matplotlib", "xarray", "typer"),
        ),
        # Of the studies the one that is asked for.
        (
            "fp.load, fp.studies.cross_check",
            ("matplotlib", "typer", "fpsolve.studies.ergodicity.averages"),
        ),
    ],
)
def test_names_load_only_what_they_need(statement, unwanted):
    loaded = run(
        f"import fpsolve as fp, sys; {statement};"
        f"print([m for m in {unwanted!r} if m in sys.modules])"
    )
    assert loaded.strip() == "[]"


def test_import_is_fast_as_it_loads_the_standard_library_only():
    # 0.02 s of CPU time were measured, which depends on the machine and its load.
    others = run(
        "import sys; before = set(sys.modules); import fpsolve\n"
        "roots = {name.split('.')[0] for name in sys.modules.keys() - before}\n"
        "print(sorted(roots - sys.stdlib_module_names))"
    )
    assert others.strip() == "['fpsolve', 'lazy_loader']"


def test_importing_the_schemes_compiles_nothing():
    # numba would announce it; compilation is lazy.
    compiled = run(
        "from numba.core import event\n"
        "listener = event.RecordingListener()\n"
        "with event.install_listener('numba:compile', listener):\n"
        "    import fpsolve as fp; fp.solve, fp.drift_kick, fp.semi_lagrangian\n"
        "print(len(listener.buffer))"
    )
    assert compiled.strip() == "0"


def run(code):
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    return result.stdout
