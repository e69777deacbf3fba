"""Whatever is handed over: it works, or an error of the project says what is wrong."""

import re
import tomllib
import warnings

import numpy as np
import pytest
import strategies as given_
from hypothesis import given
from hypothesis import strategies as st
from malformed import configurations, files, problems
from solutions import relaxing_solution

import fpsolve as fp
from fpsolve.cli.config import RunConfig, read_config
from fpsolve.errors import ConfigurationError, FileFormatError
from fpsolve.evolution.schedule import make_schedule
from fpsolve.model.laydown import LayDownModel

PROCESS = {"sigma1": 0.01, "sigma2": 0.01, "noise": 16.0, "speed_ratio": 0.1,
           "spinning_speed": 50.0}  # fmt: skip
# What takes one value in the place of an argument.
TAKERS = {
    "noise": lambda x: LayDownModel(fp.QuadraticPotential(), x),
    "potential": lambda x: LayDownModel(x, 1.0),
    "curve": lambda x: LayDownModel(fp.QuadraticPotential(), 1.0, x),
    "deviation": fp.QuadraticPotential,
    "slope": fp.LinearPotential,
    "exponent": fp.PowerPotential,
    "belt": fp.MovingBelt,
    "radius": lambda x: fp.RotatingNozzle(0.1, x, 1.0),
    "half width": lambda x: fp.PhaseSpaceGrid(x, (8, 8, 8)),
    "shape": lambda x: fp.PhaseSpaceGrid(6.0, x),
    "number of cells": lambda x: fp.PhaseSpaceGrid(6.0, (8, 8, x)),
    "cells of a plane": lambda x: fp.PlaneGrid(6.0, (8, x)),
    "mean": lambda x: fp.initial.gaussian(problems.grid(), x),
    "variance": lambda x: fp.initial.gaussian(problems.grid(), variance=x),
    "angle": lambda x: fp.initial.gaussian(problems.grid(), angle=x),
    "grid": fp.initial.gaussian,
    "span": lambda x: make_schedule(x, 0.25),
    "step": lambda x: make_schedule((0.0, 1.0), x),
    "places": lambda x: make_schedule((0.0, 1.0), 0.25, x),
    "records": lambda x: make_schedule((0.0, 1.0), 0.25, None, x),
    "density": lambda x: problems.grid().check(x, "p"),
    "point": fp.paths.PointLaw,
    "covariance": lambda x: fp.paths.GaussianLaw(variance=x),
    "throwing range": lambda x: fp.Process(**{**PROCESS, "sigma1": x}),
    "speed ratio": lambda x: fp.Process(**{**PROCESS, "speed_ratio": x}),
    "energy": lambda x: problems.energy().period(x),
    "place": lambda x: problems.solution().density(x),
    "path": lambda x: fp.load(x),
    "order": lambda x: fp.drift_kick(
        problems.model(), problems.grid(), interpolation_order=x),
    "table": lambda x: fp.TabulatedCurve(x, x, x),
    "tolerance": lambda x: fp.suggest_grid(problems.model(), x),
}  # fmt: skip


@pytest.mark.parametrize("take", TAKERS.values(), ids=TAKERS)
@given_.few(0.3)
@given(value=given_.anything)
def test_a_value_works_or_is_named(take, value):
    with warnings.catch_warnings():
        # What is unusual is said by a warning; here no matter.
        warnings.simplefilter("ignore", UserWarning)
        _, error = given_.outcome(lambda: take(value))
    if error:
        assert re.search(r"`[\w \[\]()]+`", str(error)), error
        assert re.search("must|cannot read", str(error)), error


@given_.few(0.5)
@given(st.text(max_size=200))
def test_any_text_is_a_configuration_or_is_refused(text):
    with pytest.raises(ConfigurationError, match="configuration"):
        read_config(text)


@st.composite
def spoilt_configurations(draw):
    """The valid file with a few pieces cut out, doubled, or put elsewhere."""
    text = configurations.RUN.decode()
    for _ in range(draw(st.integers(1, 3))):
        start = draw(st.integers(0, len(text) - 1))
        piece = text[start : start + draw(st.integers(1, 12))]
        place = draw(st.integers(0, len(text)))
        how = draw(st.sampled_from(["cut", "doubled", "foreign"]))
        if how == "cut":
            text = text.replace(piece, "", 1)
        elif how == "doubled":
            text = text[:place] + piece + text[place:]
        else:
            text = text[:place] + draw(st.text(max_size=3)) + text[place:]
    return text


@given_.few(0.5)
@given(spoilt_configurations())
def test_a_spoilt_configuration_works_or_is_refused(text):
    config, error = given_.outcome(lambda: read_config(text))
    if error:
        assert isinstance(error, ConfigurationError)
    else:
        assert read_config(config.to_toml()) == config


potential_sections = st.one_of(
    st.fixed_dictionaries(
        {"kind": st.just("quadratic"), "sigma1": given_.between(0.1, 9.0)}
    ),
    st.fixed_dictionaries({"kind": st.just("linear"), "slope": given_.between(0.1, 9)}),
    st.fixed_dictionaries(
        {"kind": st.just("power"), "exponent": given_.between(1.0, 9.0)}
    ),
)
curve_sections = st.one_of(
    st.just({"kind": "fixed_belt"}),
    st.fixed_dictionaries({"kind": st.just("moving_belt"), "speed": given_.speeds}),
    st.fixed_dictionaries(
        {
            "kind": st.just("rotating_nozzle"),
            "speed": given_.speeds,
            "radius": given_.between(0.0, 2.0),
            "angular_speed": given_.angular_speeds,
        }
    ),
)
scheme_sections = st.one_of(
    given_.drift_kick_options.map(lambda one: {"kind": "drift_kick", **one}),
    given_.semi_lagrangian_options.map(lambda one: {"kind": "semi_lagrangian", **one}),
)
names = st.text(st.characters(categories=["L", "N"]), min_size=1, max_size=8)
configurations_given = st.fixed_dictionaries(
    {
        "potential": potential_sections,
        "model": st.fixed_dictionaries({"noise": given_.between(0.0, 1e6)}),
        "curve": curve_sections,
        "grid": st.fixed_dictionaries(
            {
                "half_width": given_.between(1e-3, 1e3),
                "shape": st.tuples(*[st.integers(4, 512)] * 3),
            }
        ),
        "initial": st.just({"kind": "equilibrium"}),
        "scheme": scheme_sections,
        "run": st.fixed_dictionaries(
            {
                "s_end": st.integers(1, 100).map(float),
                "ds": given_.steps,
                "extrapolate": st.booleans(),
                "mass_tolerance": st.sampled_from([1e-12, 1e-3, float("inf")]),
            }
        ),
        "output": st.fixed_dictionaries({"name": names}),
    }
)


@given_.few(0.5)
@given(configurations_given)
def test_every_configuration_survives_being_written(tables):
    config = RunConfig.model_validate(tables)
    text = config.to_toml()
    assert read_config(text) == config
    assert tomllib.loads(text)["run"]["ds"] == tables["run"]["ds"]


@given_.few(0.1)
@given(
    given_.named_potentials, given_.noises, given_.curves, st.booleans(),
    st.sampled_from(["h5netcdf", "zarr"]), st.sampled_from([(), (0.0,), (1.0, 5.0)]),
)  # fmt: skip
def test_every_solution_survives_a_file_bit_for_bit(
    tmp_path_factory, potential, noise, curve, errors, engine, saved
):
    model = LayDownModel(potential, noise, curve)
    written = relaxing_solution(model, saved=saved, errors=errors and bool(saved))
    path = written.save(tmp_path_factory.mktemp("stored") / "result", engine)
    found = fp.load(path)
    assert found.model == model
    assert found.densities.tobytes() == written.densities.tobytes()
    for name, series in written.series.items():
        assert found.series[name].tobytes() == series.tobytes()


@given_.few(0.2)
@given(place=st.floats(0.0, 1.0, exclude_max=True), bit=st.integers(0, 7))
def test_a_flipped_bit_is_recognised_or_harmless(content, place, bit):
    path, original, expected = content
    damaged = bytearray(original)
    damaged[int(place * len(damaged))] ^= 1 << bit
    path.write_bytes(damaged)
    found, error = given_.outcome(lambda: fp.load(path))
    if error:
        assert isinstance(error, FileFormatError)
    else:
        assert found.densities.tobytes() == expected.densities.tobytes()
        assert found.model == expected.model


@pytest.fixture(scope="module")
def content(tmp_path_factory):
    expected = files.solution()
    path = expected.save(tmp_path_factory.mktemp("flipped") / "result.nc")
    return path, path.read_bytes(), expected


@given_.few(0.5)
@given(
    st.integers(-100, 100), st.integers(1, 400), given_.steps, st.integers(1, 50),
    st.data(),
)  # fmt: skip
def test_a_schedule_stops_where_it_was_asked_to(begin, n_steps, ds, every, data):
    saves = data.draw(st.lists(st.integers(0, n_steps), max_size=5))
    places = [begin + step * ds for step in saves]
    span = (float(begin), begin + n_steps * ds)
    schedule = make_schedule(span, ds, places, every)
    assert schedule.n_steps == n_steps
    assert schedule.saves == tuple(sorted(set(saves)))
    assert set(schedule.saves) <= set(schedule.records)
    assert schedule.records[0] == 0
    assert schedule.records[-1] == n_steps
    assert np.diff(schedule.records).max(initial=1) <= every
    finer = schedule.refined()
    assert [finer.s(step) for step in finer.saves] == [
        schedule.s(step) for step in schedule.saves
    ]


@given_.few(0.5)
@given(given_.potentials, given_.between(-4, 4), given_.between(-4, 4),
       given_.between(0, 2 * np.pi))  # fmt: skip
def test_the_gradient_is_that_of_the_value(potential, xi1, xi2, direction):
    h = 1e-5
    c, s = np.cos(direction), np.sin(direction)
    if np.hypot(xi1, xi2) < 0.1:
        xi1 += 0.5  # |ξ| has a kink at the origin
    ahead = potential.value(xi1 + h * c, xi2 + h * s)
    behind = potential.value(xi1 - h * c, xi2 - h * s)
    slope1, slope2 = potential.gradient(xi1, xi2)
    # h² B'''/6 with third derivatives up to 100 next to the origin, and rounding of B
    # up to 1e3 over h.
    assert (ahead - behind) / (2 * h) == pytest.approx(
        c * slope1 + s * slope2, rel=1e-6, abs=1e-6
    )
