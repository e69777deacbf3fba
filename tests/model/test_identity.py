"""An object is known by what it does and holds, in every process, never by a name."""

import functools
import importlib
import subprocess
import sys
from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np
import pytest

from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import Curve, RotatingNozzle, curve_from_dict, curve_to_dict
from fpsolve.model.identity import UnidentifiedError, digest_or_none, identity_digest
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    CallablePotential,
    IsotropicPotential,
    LinearPotential,
    Potential,
    potential_from_dict,
    potential_to_dict,
)
from fpsolve.paths import DensityLaw, GaussianLaw

FACTOR = 2.0
GRID = PhaseSpaceGrid(3.0, (4, 4, 4))


def spring(k):
    return IsotropicPotential(lambda r: k * r**2 / 2, lambda r: k * r)


class Spring:
    """A spring that keeps what it was asked for."""

    def __init__(self, k):
        self.k = k

    def value(self, r):
        return self.k * r**2 / 2

    def derivative(self, r):
        return self.k * r

    @cached_property
    def twice(self):
        return 2 * self.k


def bound(k):
    one = Spring(k)
    return IsotropicPotential(one.value, one.derivative)


def force(k, xi1, xi2):
    return k * np.asarray(xi1), k * np.asarray(xi2)


def energy(k, xi1, xi2):
    return k * (np.square(xi1) + np.square(xi2)) / 2


def partial(k):
    return CallablePotential(functools.partial(energy, k), functools.partial(force, k))


@dataclass(frozen=True)
class Stiff(Potential):
    """A user's class that calls itself like one of ours, with its parameters."""

    sigma1: float = 1.0
    sigma2: float = 1.0
    kind = "quadratic"
    formula = latex = "B"

    def value(self, xi1, xi2):
        return energy(2 * self.sigma1, xi1, xi2)

    def gradient(self, xi1, xi2):
        return force(2 * self.sigma1, xi1, xi2)


class Plain(Potential):
    """No dataclass, so that it has no dictionary."""

    formula = latex = "B"

    def __init__(self, k):
        self.k = k

    def value(self, xi1, xi2):
        return energy(self.k, xi1, xi2)

    def gradient(self, xi1, xi2):
        return force(self.k, xi1, xi2)


@dataclass(frozen=True)
class Swing(Curve):
    """A curve of user code whose parameter is no field of it."""

    speed: float = 0.0
    kind = "swing"
    autonomous = fixed = False
    formula = latex = "swing"

    def position(self, s):
        return self.reach * (1 - np.cos(s)), 0.0 * np.asarray(s)

    def velocity(self, s):
        return self.reach * np.sin(s), 0.0 * np.asarray(s)

    def displacement(self, s0, s1):
        return float(self.reach * (np.cos(s0) - np.cos(s1))), 0.0


def swing(reach):
    return type("Swing", (Swing,), {"reach": reach})()


def density(k):
    p = np.ones(GRID.shape)
    p[0, 0, 0] = k
    return DensityLaw(GRID, p)


def scaled_by_a_global(x):
    return FACTOR * x


def compiled(k):
    return numba.njit(lambda x: k * x)


MAKERS = {
    "closures": spring,
    "bound methods": bound,
    "partial functions": partial,
    "classes of potentials": Plain,
    "models": lambda k: LayDownModel(spring(k), 1.0),
    "curves": swing,
    "densities": density,
    "laws": lambda k: GaussianLaw((k, 0.0)),
    "nozzles": lambda k: RotatingNozzle(0.1, k / 9, 1.0),
    "arrays": lambda k: np.array([k, 0.0]),
    "hidden numbers": lambda k: np.ma.masked_array([1.0, 4.0], [k > 1, k < 4]),
    "nested data": lambda k: {"a": [1, (k, {"b": frozenset({k, "c"})})], 3: b"d"},
    "seeds": lambda k: np.random.SeedSequence(int(k)),
    "defaults": lambda k: eval(f"lambda x, k={k}: k * x"),
    "constants": lambda k: eval(f"lambda x: {k} * x"),
    "inner functions": lambda k: eval(f"lambda x: [{k} * y for y in (lambda z: z)(x)]"),
    "classes": lambda k: type("Own", (), {"k": k, "ask": property(lambda self: k)}),
    "vectorized functions": lambda k: np.vectorize(lambda x: k * x),
    "compiled functions": compiled,
    "functions that remember": lambda k: functools.lru_cache(lambda x: k * x),
}


@pytest.mark.parametrize("kind", MAKERS)
def test_equal_things_built_twice_are_one_and_others_are_not(kind):
    first, again, other = (identity_digest(MAKERS[kind](k)) for k in (1.0, 1.0, 4.0))
    assert first == again
    assert first != other


def test_an_identity_is_the_same_in_another_process():
    # Sets and hashes of texts come in another order there.
    asks = (
        "import importlib.util, sys\n"
        "spec = importlib.util.spec_from_file_location(*sys.argv[1:])\n"
        "t = sys.modules[sys.argv[1]] = importlib.util.module_from_spec(spec)\n"
        "spec.loader.exec_module(t)\n"
        "print(*(t.identity_digest(make(1.0)) for make in t.MAKERS.values()))"
    )
    told = subprocess.run(
        [sys.executable, "-c", asks, __name__, __file__],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    here = [identity_digest(make(1.0)) for make in MAKERS.values()]
    assert told.stdout.split() == here
    assert len(set(here)) == len(MAKERS)


def test_what_a_function_names_belongs_to_it(monkeypatch):
    before = identity_digest(scaled_by_a_global)
    assert identity_digest(scaled_by_a_global) == before
    monkeypatch.setitem(globals(), "FACTOR", 3.0)
    assert identity_digest(scaled_by_a_global) != before


@pytest.mark.parametrize(
    "asks",
    [
        "import helping\ndef f(x):\n    return helping.own(x)",
        "from helping import own\ndef f(x):\n    return own(x)",
        "def f(x):\n    import helping\n    return helping.own(x)",
        "def f(x):\n    from helping import own\n    return own(x)",
        "import helping\nclass C:\n    def g(self): return helping.own(1)\nf = C()",
    ],
)
def test_another_module_belongs_to_what_asks_it(asks, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    found = []
    for text in ("k = 1\ndef own(x): return k * x", "k = 4\ndef own(x): return k * x"):
        (tmp_path / "helping.py").write_text(text)
        monkeypatch.delitem(sys.modules, "helping", raising=False)
        importlib.invalidate_caches()
        # Files of one second have one time, by which an old compilation looks new.
        monkeypatch.setattr(sys, "dont_write_bytecode", True)
        space = {"__name__": "script"}
        exec(asks, space)
        found += [identity_digest(space["f"]), identity_digest(space["f"])]
    monkeypatch.delitem(sys.modules, "helping", raising=False)
    assert found[0] == found[1] != found[2] == found[3]


def test_an_edited_function_of_the_same_name_is_another():
    versions = []
    for text in ("x + 1", "x + 2", "x - 1", "abs(x)", "round(x)", "x.real", "x.imag"):
        space = {"__name__": "script"}
        exec(f"def own(x):\n    return {text}", space)
        versions.append(identity_digest(space["own"]))
    assert len(set(versions)) == 7


def test_a_series_in_another_order_is_another():
    f, g = np.cos, np.sin
    # A study returns its results in the order of the functions it was given.
    assert identity_digest({"f": f, "g": g}) != identity_digest({"g": g, "f": f})
    assert identity_digest([1, 2]) != identity_digest([2, 1]) != identity_digest((2, 1))
    assert identity_digest({1, 2}) == identity_digest({2, 1})


def test_numbers_that_compute_otherwise_are_others():
    values = [1, 1.0, True, "1", 1j, np.float32(1), np.int64(1), b"1", [1], (1,), None]
    values += [np.array(1), np.array([1]), np.array([1.0]), 1.0 + 2**-52, -0.0, 0.0]
    assert len({identity_digest(value) for value in values}) == len(values)
    assert identity_digest(np.float64(0.5)) == identity_digest(0.5)
    assert identity_digest(np.nan) == identity_digest(float("nan"))


def test_recursion_and_circles_end():
    def down(n):
        return n and down(n - 1)

    ring, other = [1], [2]
    ring.append(ring)
    other.append(other)
    assert identity_digest(down) == identity_digest(down)
    assert identity_digest(ring) != identity_digest(other)
    deep = []
    for _ in range(10 * sys.getrecursionlimit()):
        deep = [deep]
    with pytest.raises(UnidentifiedError):
        identity_digest(deep)


def test_what_a_property_has_kept_changes_nothing():
    one, potential = Spring(1.0), spring(2.0)
    before = identity_digest([one, potential])
    assert one.twice == 2.0
    # Z = 2π/k, to the tolerance of the quadrature.
    assert potential.partition_function == pytest.approx(np.pi, rel=1e-8)
    assert identity_digest([one, potential]) == before


def test_code_of_packages_is_known_by_its_name():
    named = [np.cos, np.sin, np.linalg.norm, len, dict.get, LinearPotential, np.random]
    assert len({identity_digest(one) for one in named}) == len(named)


def test_what_has_neither_code_nor_data_has_no_identity(tmp_path):
    with (tmp_path / "file").open("w") as file:
        # A universal function of python code has a name that is not its own.
        for value in (file, file.write, np.frompyfunc(lambda x: x, 1, 1)):
            with pytest.raises(
                UnidentifiedError, match="cannot be told from others by"
            ):
                identity_digest({"inside": [value]})
            assert digest_or_none(value) is None


def test_a_potential_without_data_is_known_by_what_it_computes(tmp_path):
    def reading(k, file):
        def derivative(r):
            file.flush()
            return k * r

        return IsotropicPotential(lambda r: k * r**2 / 2, derivative)

    with (tmp_path / "file").open("w") as file:
        one, again, other = (identity_digest(reading(k, file)) for k in (1.0, 1.0, 4.0))
        assert digest_or_none(reading(1.0, file), sampled=False) is None
    assert one == again != other


POTENTIALS = [spring, bound, partial, Plain, Stiff]


@pytest.mark.parametrize("make", POTENTIALS)
def test_a_described_potential_says_what_it_computes(make):
    first, again, other = (potential_to_dict(make(k)) for k in (1.0, 1.0, 4.0))
    assert first == again
    assert first["sampled"] != other["sampled"]
    with pytest.raises(ValueError, match=r"`(potential|kind)` .*must (not )?be "):
        potential_from_dict(first)


# How far a difference extends, relative to its distance from the origin: see
# `digest_of_potential`.
@pytest.mark.parametrize("width", [0.2, 0.1])
@pytest.mark.parametrize("distance", [0.01, 0.3, 1.0, 5.0, 200.0])
def test_a_difference_anywhere_in_the_plane_is_seen(distance, width):
    place = distance * np.exp(1j * np.linspace(0, 6, 7))

    def bumped(at):
        def value(xi1, xi2):
            away = np.hypot(xi1 - at.real, xi2 - at.imag) < width * distance / 2
            return energy(1.0, xi1, xi2) + 1e-9 * away

        return CallablePotential(value, functools.partial(force, 1.0))

    digests = {potential_to_dict(bumped(at))["sampled"] for at in place}
    assert len(digests) == len(place)


def test_functions_that_raise_or_overflow_can_be_described():
    def value(r):
        if np.max(r) > 100:
            raise RuntimeError("too far")
        return np.exp(r) / 10

    near = IsotropicPotential(value, lambda r: np.exp(r) / 10)
    far = IsotropicPotential(lambda r: np.exp(r) / 10, lambda r: np.exp(r) / 10)
    assert potential_to_dict(near)["sampled"] != potential_to_dict(far)["sampled"]


def test_a_class_that_has_the_kind_of_another_is_not_read_back_as_its_parent():
    description = potential_to_dict(Stiff())
    assert description["kind"] == "quadratic"
    with pytest.raises(ValueError, match="`potential` must not be of your own code"):
        potential_from_dict(description)
    nozzle = type("Own", (RotatingNozzle,), {})(0.1, 0.2, 0.3)
    with pytest.raises(ValueError, match="`curve` must not be of your own code"):
        curve_from_dict(curve_to_dict(nozzle))
    model = LayDownModel(Stiff(), 1.0).to_dict()
    with pytest.raises(ValueError, match="`potential` must not be of your own code"):
        LayDownModel.from_dict(model)


def test_a_described_curve_says_where_it_runs():
    first, again, other = (curve_to_dict(swing(k)) for k in (1.0, 1.0, 3.0))
    assert first == again
    assert first["sampled"] != other["sampled"]


def test_a_curve_that_takes_one_arclength_at_a_time_is_seen_too():
    def scalar(reach):
        def position(self, s):
            return (reach, 0.0) if s > 2.0 else (0.0, 0.0)

        return type("Jump", (Swing,), {"reach": 0.1, "position": position})()

    one, again, other = (curve_to_dict(scalar(k))["sampled"] for k in (1.0, 1.0, 2.0))
    assert one == again != other
