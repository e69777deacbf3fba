"""Imports go down the floors only: at load, inside functions and for type checkers."""

import ast
from functools import cache
from pathlib import Path

import fpsolve

PACKAGE = Path(fpsolve.__file__).parent
# From the ground up. Rooms of one floor do not know each other: the oracles (paths,
# spectral, reduced) and the grid solver answer the same questions independently.
FLOORS = (
    ("errors",),
    ("_kernels",),
    ("_support",),
    ("model",),
    ("grids",),
    ("evolution",),
    ("density", "paths", "spectral", "reduced"),
    ("web", "fibre"),
    ("studies", "interop"),
    ("results",),
    ("plotting",),
    ("pages",),
    ("cli",),
)
FLOOR = {room: number for number, rooms in enumerate(FLOORS) for room in rooms}
# The public names, and the command as a module, are above everything.
ROOF = ("", "__main__")
# In studies: tools, then questions, which do not know each other.
QUESTIONS = {
    "agreement", "ergodicity", "rates", "limits", "webs", "design", "identification",
}  # fmt: skip
# Loaded where they are used, in these rooms only; pydantic also checks what files say.
GUESTS = {
    "matplotlib": {"plotting", "pages", "interop"},
    "typer": {"cli"}, "click": {"cli"}, "rich": {"cli"},
    "pydantic": {"cli", "_support"}, "pde": {"interop"}, "jinja2": {"pages"},
    "dask": {"studies"}, "distributed": {"studies"},
}  # fmt: skip
# Slow to import: inside functions only, where a room is loaded by `import fpsolve`.
SLOW = {"xarray", "zarr", "h5netcdf", "pydantic"}
FILES = sorted(PACKAGE.rglob("*.py"))


def name_of(path):
    """`density.schemes.form` for fpsolve/density/schemes/form.py."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(path): path for path in FILES}


def module_of(imported):
    """The module that a dotted name of the package stands for, or lies in."""
    name = imported.removeprefix("fpsolve").lstrip(".")
    while name not in MODULES:
        name = name.rpartition(".")[0]
    return name


@cache
def imports(path):
    """Every name that a file imports, wherever the import stands."""
    found = []
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: name the module from the package on"
            found += [f"{node.module}.{alias.name}" for alias in node.names]
    return found


@cache
def neighbours(name):
    """The modules of the package that a module imports."""
    own = {one for one in imports(MODULES[name]) if one.split(".")[0] == "fpsolve"}
    return {module_of(one) for one in own} - {name}


def room(name):
    return name.split(".")[0]


def question(name):
    """The question of the studies that a module belongs to, if it does."""
    parts = name.split(".")
    return parts[1] if parts[0] == "studies" and len(parts) > 1 else ""


def test_every_file_is_in_a_room():
    assert {room(name) for name in MODULES} - set(ROOF) == set(FLOOR)


def may_import(name, other):
    """Whether a module may import another one; of the package its name is empty."""
    if other == "":
        # Of the whole package its rooms only: `from fpsolve import plotting`.
        return FLOOR[room(name)] > FLOOR["studies"]
    if room(other) != room(name):
        return FLOOR[room(other)] < FLOOR[room(name)]
    if question(other) not in QUESTIONS:
        return True
    # Of the studies of a question know those of the same one, and what asks them all.
    return question(name) in (question(other), "")


def test_a_file_imports_what_is_below_it():
    wrong = [
        f"{name} imports {other or 'the package: name the module'}"
        for name in MODULES
        if name not in ROOF
        for other in neighbours(name)
        if not may_import(name, other)
    ]
    assert wrong == []


def test_guests_stay_in_their_rooms():
    for name, path in MODULES.items():
        for imported in imports(path):
            rooms = GUESTS.get(imported.split(".")[0])
            assert rooms is None or room(name) in rooms, f"{name}: {imported}"


def test_what_is_slow_to_import_waits_for_its_use():
    for name, path in MODULES.items():
        if room(name) in ("", "cli", "pages", "plotting", "interop", "__main__"):
            continue
        tree = ast.parse(path.read_text("utf-8"))
        for node in tree.body:
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                names = [node.module]
            slow = {one.split(".")[0] for one in names} & SLOW
            assert not slow, f"{name} imports {slow} at load"


def test_no_module_comes_back_to_itself():
    left = {name: set(neighbours(name)) for name in MODULES}
    while left:
        free = [name for name, below in left.items() if not below & left.keys()]
        assert free, f"a circle among {sorted(left)}"
        for name in free:
            del left[name]


def test_modules_are_named_and_not_the_packages_that_pass_their_names_on():
    for name, path in MODULES.items():
        if path.name == "__init__.py" or name in ROOF:
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module.startswith("fpsolve."):
                home = module_of(node.module)
                if MODULES[home].name != "__init__.py":
                    continue
                for alias in node.names:
                    inside = f"{home}.{alias.name}"
                    assert inside in MODULES, f"{name}: {alias.name} from {home}"


def test_the_rule_sees_imports_everywhere(tmp_path):
    file = tmp_path / "one.py"
    file.write_text(
        "from typing import TYPE_CHECKING\n"
        "if TYPE_CHECKING:\n    from fpsolve.cli import app\n"
        "def f():\n    import fpsolve.pages.page\n"
    )
    assert set(imports(file)) >= {"fpsolve.cli.app", "fpsolve.pages.page"}
    assert module_of("fpsolve.pages.page.report") == "pages.page"
