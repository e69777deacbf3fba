"""The interface page lists every public name; docstrings say what goes in and out."""

import importlib
import inspect
import re
from pathlib import Path
from types import ModuleType

import pytest

import fpsolve as fp

PAGE = Path(__file__).parents[2] / "docs/api.md"
DIRECTIVE = re.compile(r"^\.\. auto(module|class|function):: (\S+)$", re.MULTILINE)


def public_names():
    """Every name of the package and of its public modules, once: path and object."""
    modules = {"fpsolve": fp}
    modules |= {
        f"fpsolve.{name}": value
        for name in fp.__all__
        if isinstance(value := getattr(fp, name), ModuleType)
    }
    return {
        f"{module}.{name}": getattr(owner, name)
        for module, owner in modules.items()
        for name in owner.__all__
    }


def found(path):
    """The object at a dotted path; modules come before names that hide them."""
    parts = path.split(".")
    for cut in range(len(parts), 0, -1):
        try:
            value = importlib.import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            continue
        for name in parts[cut:]:
            value = getattr(value, name)
        return value
    raise AssertionError(f"{path} does not exist")


def documented():
    """Identities of the objects on the page."""
    objects = []
    for kind, path in DIRECTIVE.findall(PAGE.read_text("utf-8")):
        value = found(path)
        objects.append(value)
        if kind == "module":
            objects += [getattr(value, name) for name in value.__all__]
    return {id(value) for value in objects}


# What stands for an equation, a figure or a method of somebody says whose it is.
SOURCED = [
    "EllipticNozzle",
    "EnergyProcess",
    "FixedBelt",
    "HydrodynamicLimit",
    "LayDownModel",
    "LinearPotential",
    "MovingBelt",
    "OrnsteinUhlenbeckLimit",
    "OscillatingNozzle",
    "PowerPotential",
    "Process",
    "QuadraticPotential",
    "RotatingNozzle",
    "diagnostics.entropy_dissipation",
    "diagnostics.relative_entropy",
    "drift_kick",
    "initial.equilibrium",
    "interop.FokkerPlanckPDE",
    "interop.HydrodynamicPDE",
    "interop.relative_entropy",
    "optimal_noise",
    "paths.EquilibriumLaw",
    "plotting.plot_fibre",
    "plotting.plot_inverse_decay_rate",
    "plotting.plot_nozzles",
    "plotting.plot_orbits",
    "plotting.plot_trajectories",
    "sample_paths",
    "semi_lagrangian",
    "solve",
    "spectral_gap",
    "spectral_solve",
    "spectral_steady_state",
    "spectrum",
    "steady_state",
    "studies.asymptotic_variances",
    "studies.ergodic_averages",
    "studies.fit_ergodic_error",
    "studies.large_noise_limit",
    "studies.rate_versus_noise",
    "studies.small_noise_limit",
    "studies.small_noise_spectrum",
]

NAMES = public_names()
LISTED = documented()
# Parts of a docstring by what they hold.
CALLABLES = {
    path: value
    for path, value in NAMES.items()
    if inspect.isroutine(value) or inspect.isclass(value)
}


def section(text, title):
    """The lines below a heading of a docstring, up to the next heading."""
    match = re.search(
        rf"^{title}\n-+\n(.*?)(?=^\S[^\n]*\n---|\Z)", text, re.MULTILINE | re.DOTALL
    )
    return "" if match is None else match[1]


def described(text):
    """Names that the parameters and attributes of a docstring describe."""
    lines = section(text, "Parameters") + "\n" + section(text, "Attributes")
    heads = re.findall(r"^(\*{0,2}\w[\w, *]*?)(?: : .*)?$", lines, re.MULTILINE)
    return {name.strip(" *") for head in heads for name in head.split(",")}


def test_every_public_name_is_on_the_interface_page():
    text = PAGE.read_text("utf-8")
    missing = [
        path
        for path, value in NAMES.items()
        if id(value) not in LISTED
        and not (isinstance(value, ModuleType) and f"`{path}`" in text)
    ]
    assert missing == []


def undescribed(value):
    """Arguments of a class or a function that no docstring describes."""
    try:
        parameters = inspect.signature(value).parameters
    except ValueError:
        parameters = {}
    given = {name for name in parameters if not name.startswith("_")}
    # What a base class of the package takes is said there.
    bases = inspect.getmro(value) if inspect.isclass(value) else (value,)
    texts = [base.__doc__ for base in bases if base.__module__.startswith("fpsolve")]
    said = set().union(*(described(inspect.cleandoc(text or "")) for text in texts))
    return given - said


def test_every_argument_of_a_public_name_is_described():
    found = {path: undescribed(value) for path, value in CALLABLES.items()}
    assert {path: names for path, names in found.items() if names} == {}


def says_what_it_returns(function):
    text = inspect.getdoc(function)
    # One line is enough where the line is the formula of a number.
    return section(text, "Returns") or re.search(
        r"[=∫Σ]|^[A-Z]", text.partition("\n")[0]
    )


def test_every_public_function_says_what_it_returns():
    silent = [
        path
        for path, value in CALLABLES.items()
        if not inspect.isclass(value)
        and inspect.signature(value).return_annotation not in (None, "None")
        and not says_what_it_returns(value)
    ]
    assert silent == []


def test_sources_are_keys_of_the_references():
    page = (PAGE.parent / "references.md").read_text("utf-8")
    known = set(re.findall(r"^\.\. \[(\w+)\]", page, re.MULTILINE))
    cited = {
        path: set(re.findall(r"\[(\w+)\]_", inspect.getdoc(value)))
        for path, value in CALLABLES.items()
    }
    assert {path: keys for path, keys in cited.items() if not keys <= known} == {}


@pytest.mark.parametrize("name", SOURCED)
def test_equations_and_methods_name_their_source(name):
    text = inspect.getdoc(NAMES[f"fpsolve.{name}"])
    assert re.search(r"\[\w+\]_", section(text, "References"))
