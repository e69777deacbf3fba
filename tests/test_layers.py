"""Imports go down the floors only, and the oracles never meet the solver."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "fpsolve"
FLOORS = {
    "errors": 0, "_kernels": 0, "_arrays": 0, "_checks": 0, "_blas": 0, "_threads": 0,
    "environment": 0, "_compilation": 0, "_digests": 0, "_json": 0,
    "potentials": 1, "curves": 1, "models": 1,
    "cells": 2, "grids": 2, "planes": 2, "initial": 2, "diagnostics": 2,
    "functionals": 2, "circulation": 2, "process": 2, "decay": 2,
    "matrix_pencil": 2, "densities": 2, "interrupts": 2, "identity": 2,
    "schedule": 2, "memory": 2, "progress": 2, "provenance": 2,
    "paths": 2, "spectral": 2, "reduced": 2,
    "schemes": 3,
    "run": 4, "run_description": 4, "keeping": 4, "checkpoints": 4, "resuming": 4,
    "solution": 4, "solve": 4, "recording": 4, "extrapolation": 4, "steady_state": 4,
    "suggestions": 4, "stationary": 4,
    "io": 6, "plotting": 6, "config": 6, "studies": 6, "cli": 6, "interop": 6,
    "comparisons": 6, "rerunning": 6,
    "report": 6, "boxes": 6,
    "__main__": 6,
}  # fmt: skip
# Independent answers to the same question: they never import each other, nor, being
# on floor 2, the solver, not even inside a function.
ORACLES = {"paths", "spectral", "reduced"}
SOLVER = {name for name, floor in FLOORS.items() if floor in (3, 4)}
ENTRY_ONLY = {"matplotlib", "typer", "rich", "dask", "xarray", "pydantic", "zarr"}


def module_of(path):
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imports_at_load(tree):
    """Modules imported by top-level statements, those for type checkers aside."""
    for node in tree.body:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_every_module_has_a_floor():
    found = {module_of(path) for path in PACKAGE.rglob("*.py")} - {"__init__"}
    assert found <= FLOORS.keys()


def test_imports_go_down_the_floors_only():
    for path in PACKAGE.rglob("*.py"):
        own = FLOORS.get(module_of(path))
        if own is None:
            continue
        for name in imports_at_load(ast.parse(path.read_text())):
            parts = name.split(".")
            if parts[0] == "fpsolve" and len(parts) > 1 and parts[1] in FLOORS:
                assert FLOORS[parts[1]] <= own, f"{path.name} imports {name}"
            if own < 6:
                assert parts[0] not in ENTRY_ONLY, f"{path.name} imports {name}"


def all_imports(tree):
    """Modules imported anywhere, inside functions and for type checkers too."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_the_oracles_import_neither_the_solver_nor_each_other():
    for oracle in ORACLES:
        for path in (PACKAGE / oracle).rglob("*.py"):
            for name in all_imports(ast.parse(path.read_text())):
                parts = name.split(".")
                if parts[0] == "fpsolve" and len(parts) > 1:
                    forbidden = (SOLVER | ORACLES) - {oracle}
                    assert parts[1] not in forbidden, f"{path.name} imports {name}"


def test_nothing_below_the_studies_imports_an_oracle():
    for path in PACKAGE.rglob("*.py"):
        own = module_of(path)
        if own in ORACLES or FLOORS.get(own, 6) >= 6:
            continue
        for name in all_imports(ast.parse(path.read_text())):
            parts = name.split(".")
            if parts[0] == "fpsolve" and len(parts) > 1:
                assert parts[1] not in ORACLES, f"{path.name} imports {name}"
