"""Configurations say what they mean, and wrong ones say what was meant."""

import inspect
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fpsolve as fp
from fpsolve.cli import plan
from fpsolve.cli.config import (
    EXAMPLES,
    DesignConfig,
    PathsConfig,
    RunConfig,
    WebConfig,
    example_path,
    load_config,
    read_config,
)
from fpsolve.cli.config.complaints import _SECTIONS, suggestion
from fpsolve.density.suggestions import suggest_step
from fpsolve.errors import ConfigurationError
from fpsolve.studies.suggested_grid import suggest_grid

TEXT = """
[potential]
kind = "quadratic"
sigma1 = 1.0

[model]
noise = 1.0

[curve]
kind = "moving_belt"
speed = 0.1

[grid]
half_width = 6.0
shape = [16, 16, 8]

[initial]
kind = "gaussian"
mean = [0.5, 0.0]

[scheme]
kind = "drift_kick"

[run]
s_end = 1.0
ds = 0.25
save_at = [0.5, 1.0]
"""
PROCESS = """
[process]
sigma1 = 0.01
sigma2 = 0.02
noise = 16.0
speed_ratio = 0.1
spinning_speed = 50.0
"""
WITHOUT_MODEL = TEXT[TEXT.index("[grid]") :]


def test_a_configuration_builds_what_python_would():
    problem = read_config(TEXT).build()
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1))
    grid = fp.PhaseSpaceGrid(6.0, (16, 16, 8))
    assert problem.model == model
    assert problem.grid == grid
    expected = fp.initial.gaussian(grid, mean=(0.5, 0.0))
    np.testing.assert_array_equal(problem.p0, expected)
    assert problem.scheme.name == "drift_kick"
    assert problem.arguments == {
        "s_span": (0.0, 1.0),
        "ds": 0.25,
        "save_at": (0.5, 1.0),
        "record_every": 1,
        "extrapolate": False,
    }


def test_a_process_in_si_units_takes_the_place_of_the_model():
    problem = read_config(PROCESS + WITHOUT_MODEL).build()
    assert problem.model == fp.Process(0.01, 0.02, 16.0, 0.1, 50.0).model


def test_the_equilibrium_belongs_to_the_potential():
    text = TEXT.replace('kind = "gaussian"\nmean = [0.5, 0.0]', 'kind = "equilibrium"')
    problem = read_config(text).build()
    expected = fp.initial.equilibrium(problem.grid, problem.model.potential)
    np.testing.assert_array_equal(problem.p0, expected)


def test_options_reach_the_scheme():
    options = 'kind = "semi_lagrangian"\nsplitting = "lie"\ninterpolation_order = 6'
    problem = read_config(TEXT.replace('kind = "drift_kick"', options)).build()
    assert problem.scheme.name == "semi_lagrangian"
    assert problem.scheme.options["splitting"] == "lie"
    assert problem.scheme.options["interpolation_order"] == 6


def test_saving_at_an_interval_includes_both_ends():
    text = TEXT.replace("save_at = [0.5, 1.0]", "save_every = 0.75")
    assert read_config(text).build().arguments["save_at"] == (0.0, 0.75, 1.0)


def test_tolerances_reach_the_run():
    text = TEXT + "mass_tolerance = 1e-6\nboundary_tolerance = inf\n"
    arguments = read_config(text).build().arguments
    assert arguments["mass_tolerance"] == 1e-6
    assert arguments["boundary_tolerance"] == np.inf


def test_a_missing_grid_and_step_are_suggested_with_their_reason():
    start, end = TEXT.index("[grid]"), TEXT.index("[initial]")
    text = (TEXT[:start] + TEXT[end:]).replace("ds = 0.25\n", "tolerance = 0.1\n")
    config = read_config(text.replace("save_at = [0.5, 1.0]\n", ""))
    problem = config.build()
    # For the start and the length of this run.
    law = fp.paths.GaussianLaw((0.5, 0.0))
    suggested = suggest_grid(problem.model, 0.1, initial=law, s_end=1.0)
    assert problem.grid == suggested
    assert problem.grid.reason == suggested.reason
    ds = problem.arguments["ds"]
    assert ds <= suggest_step(problem.model, suggested, 0.1)
    assert round(1 / ds) == pytest.approx(1 / ds, rel=1e-12)
    assert "splitting error" in ds.reason
    # What was suggested is written down, so that the run can be repeated.
    again = read_config(config.resolved(problem).to_toml()).build()
    assert again.grid.to_dict() == problem.grid.to_dict()
    assert again.arguments["ds"] == ds


def test_a_missing_grid_suits_the_translations_of_the_scheme():
    start, end = TEXT.index("[grid]"), TEXT.index("[initial]")
    text = (TEXT[:start] + TEXT[end:]).replace(
        'kind = "drift_kick"', 'kind = "drift_kick"\ntranslation = "fourier"'
    )
    text = text.replace("s_end = 1.0", "s_end = 0.25").replace(
        "ds = 0.25", "ds = 0.125"
    )
    text = text.replace("save_at = [0.5, 1.0]\n", "tolerance = 0.1\n")
    problem = read_config(text).build()
    tried = fp.suggest_fourier_grid(
        problem.model,
        lambda grid: fp.initial.gaussian(grid, (0.5, 0.0)),
        0.25,
        0.1,
    )
    assert problem.grid == tried
    assert "the shortest waves hold" in problem.grid.reason


def test_levels_and_the_translation_are_said_in_a_configuration():
    text = TEXT.replace("s_end = 1.0", "s_end = 1.0\nextrapolate = 4")
    problem = read_config(text).build()
    assert problem.arguments["extrapolate"] == 4
    again = read_config(read_config(text).resolved(problem).to_toml())
    assert again.build().arguments["extrapolate"] == 4
    fourier = TEXT.replace(
        'kind = "drift_kick"', 'kind = "drift_kick"\ntranslation = "fourier"'
    )
    assert read_config(fourier).build().scheme.options["translation"] == "fourier"


def test_a_tolerance_decides_about_levels_where_it_is_asked_to():
    text = TEXT.replace(
        "s_end = 1.0", 's_end = 1.0\nextrapolate = "auto"\ntolerance = 1e-5'
    )
    problem = read_config(text).build()
    assert problem.arguments["tolerance"] == 1e-5
    assert problem.arguments["extrapolate"] is False
    assert plan._steps(problem.arguments).count("until the step leaves 1e-05") == 1
    again = read_config(text).resolved(problem).build()
    assert again.arguments["tolerance"] == 1e-5


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_build_and_survive_writing(name):
    config = load_config(example_path(name))
    assert config.build().arguments["extrapolate"]
    assert read_config(config.to_toml()) == config


def test_the_configurations_in_the_documentation_build():
    page = Path(__file__).parents[2] / "docs" / "command_line.md"
    blocks = re.findall(r"```toml\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    run, smooth, process, paths, web, design = blocks
    assert read_config(run).build().scheme.options["positive"]
    ends = "[potential]\nkind = 'quadratic'\n" + run[run.index("[run]") :]
    start = run[run.index("[initial]") : run.index("[scheme]")]
    smooth_run = read_config(ends + smooth + start).build()
    assert smooth_run.grid.shape == (32, 32, 24, 18)
    rest = run[run.index("[grid]") :]
    assert read_config(process + rest).build().model.belt_speed == 0.1
    sampled = read_config(process + paths, kind=PathsConfig).build()
    assert sampled.model.belt_speed == 0.1
    laid = read_config(web, kind=WebConfig).build()
    assert laid.model.relaxation_length == 0.002
    assert laid.arguments["titer"] == 1.5e-4
    assert read_config(design, kind=DesignConfig).build()


def test_the_first_example_is_the_one_of_the_paper():
    problem = load_config(example_path("laydown")).build()
    assert problem.model == fp.LayDownModel(fp.QuadraticPotential(), noise=1.0)


def test_the_second_example_is_a_spunbond_process():
    problem = load_config(example_path("spunbond")).build()
    # A* = sqrt(10 mm) * 16 m^-1/2, rounding aside.
    assert problem.model.noise == pytest.approx(1.6, rel=1e-15)
    assert problem.model.belt_speed == 0.1


@given(
    noise=st.floats(0, 100),
    sigma1=st.floats(1e-6, 1e6),
    s_end=st.integers(1, 1000),
    positive=st.booleans(),
    name=st.text("abcäöü-_ '\"", min_size=1, max_size=8),
)
def test_writing_and_reading_gives_the_same_configuration(
    noise, sigma1, s_end, positive, name
):
    tables = tomllib.loads(TEXT)
    tables["model"]["noise"] = noise
    tables["potential"]["sigma1"] = sigma1
    tables["run"] = {"s_end": float(s_end), "mass_tolerance": np.inf}
    tables["scheme"]["positive"] = positive
    tables["output"] = {"name": name}
    tables["grid"]["shape"] = tuple(tables["grid"]["shape"])
    tables["initial"]["mean"] = tuple(tables["initial"]["mean"])
    config = RunConfig.model_validate(tables)
    assert read_config(config.to_toml()) == config


def test_sections_have_the_parameters_of_their_constructors():
    for name in ("potential", "curve", "initial", "scheme", "process", "grid", "model"):
        for section in _SECTIONS[name].values():
            parameters = inspect.signature(section.target).parameters.values()
            given_elsewhere = ("model", "grid", "potential", "curve")
            for parameter in parameters:
                if parameter.name in given_elsewhere:
                    continue
                field = section.model_fields[parameter.name]
                required = parameter.default is parameter.empty
                assert field.is_required() == required
                assert required or field.default == parameter.default


def test_a_suggested_step_meets_the_saving_points():
    run = read_config(TEXT.replace("ds = 0.25\n", "")).run
    # 0.3 asks for 4 steps of 0.25, which meet 0.5; 0.45 for 3, which do not.
    assert run.step(0.3) == 0.25
    assert run.step(0.45) == 0.25


# What replaces what in TEXT, and what is then said.
WRONG = {
    "misspelt key": (
        ("sigma1 = 1.0", "sigma = 1.0"),
        r"section \[potential\]: `sigma` is not a key of the kind 'quadratic'; did you "
        r"mean `sigma1`\? Keys are kind, sigma1, sigma2\.",
    ),
    "key of another section": (
        ("noise = 1.0", "noise = 1.0\nspeed = 0.1"),
        r"section \[model\]: `speed` is not a key\. Keys are noise, rel",
    ),
    "misspelt option of a scheme": (
        ('"drift_kick"', '"drift_kick"\npositiv = true'),
        r"section \[scheme\]: `positiv` is not a key of the kind 'drift_kick'; did you "
        r"mean `positive`\?",
    ),
    "misspelt section": (
        ("[curve]", "[curv]"),
        r"unknown section \[curv\]; did you mean \[curve\]\? Sections are \[potential",
    ),
    "section far from any": (
        ("[curve]", "[zzz]"),
        r"unknown section \[zzz\]\. Sections are",
    ),
    "misspelt kind": (
        ('"quadratic"', '"quadratc"'),
        r"section \[potential\]: `kind` must be one of 'quadratic', 'linear', 'power', "
        r"'free', got 'quadratc'; did you mean 'quadratic'\?",
    ),
    "missing kind": (
        ('kind = "quadratic"\n', ""),
        r"section \[potential\]: `kind` must be one of .*, got none\.",
    ),
    "missing key": (
        ("s_end = 1.0\n", ""),
        r"section \[run\]: `s_end` must be given\. Keys are s_end, ds,",
    ),
    "missing section": (
        ("[run]", "[output]"),
        r"section \[run\] must be given, got none\.",
    ),
    "text for a number": (
        ("noise = 1.0", "noise = '1.0'"),
        r"section \[model\]: `noise` must be a number, got '1\.0'\.",
    ),
    "truth value for a number": (
        ("noise = 1.0", "noise = true"),
        r"section \[model\]: `noise` must be a number, got True\.",
    ),
    "number for a truth value": (
        ("s_end = 1.0", "s_end = 1.0\nextrapolate = 1"),
        r"section \[run\]: `extrapolate` must be true or false, from 2 to 8 .* got 1\.",
    ),
    "negative number": (
        ("noise = 1.0", "noise = -1.0"),
        r"section \[model\]: `noise` must be non-negative and finite, got -1\.",
    ),
    "not a number": (
        ("noise = 1.0", "noise = nan"),
        r"section \[model\]: `noise` must be non-negative and finite, got nan\.",
    ),
    "value checked by a potential": (
        ("sigma1 = 1.0", "sigma1 = 0.0"),
        r"section \[potential\]: `sigma1` must be positive and finite, got 0\.",
    ),
    "value checked by a curve": (
        ("speed = 0.1", "speed = 2.0"),
        r"section \[curve\]: `speed` must lie strictly between -1 and 1, got 2;",
    ),
    "value of no type": (
        ("half_width = 6.0", "half_width = 'wide'"),
        r"section \[grid\]: `half_width` must be a number or a list, got 'wide'\.",
    ),
    "list too long": (
        ("half_width = 6.0", "half_width = [6.0, 6.0, 6.0]"),
        r"section \[grid\]: `half_width` must be a number or a list of 2, got \[6\.0, "
        r"6\.0, 6\.0\]\.",
    ),
    "list too short": (
        ("[16, 16, 8]", "[16, 16]"),
        r"section \[grid\]: `shape` must be a longer list, got \[16, 16\]\.",
    ),
    "entry of a list": (
        ("[16, 16, 8]", "[16, 16.0, 8]"),
        r"section \[grid\]: `shape\[1\]` must be an integer, got 16\.0\.",
    ),
    "grid too coarse": (
        ("[16, 16, 8]", "[16, 16, 2]"),
        r"section \[grid\]: `shape\[2\] \(n_alpha\)` must be at least 4, got 2\.",
    ),
    "start outside of the grid": (
        ("mean = [0.5, 0.0]", "mean = [9.0, 0.0]"),
        r"section \[initial\]: `mean` must lie inside the box .* got \(9, 0\);",
    ),
    "option of a scheme": (
        ('"drift_kick"', '"drift_kick"\ninterpolation_order = 5'),
        r"section \[scheme\]: `interpolation_order` must be .*, got 5",
    ),
    "step": (
        ("ds = 0.25", "ds = 0.3"),
        r"section \[run\]: `ds` must divide the span 1 into whole steps, got 0\.3; use "
        r"ds = 0\.25\.",
    ),
    "saving point": (
        ("[0.5, 1.0]", "[0.6]"),
        r"section \[run\]: `save_at` must hold multiples of ds = 0\.25 .*, got 0\.6;",
    ),
    "saving point beside a suggested step": (
        ("ds = 0.25\nsave_at = [0.5, 1.0]", "save_at = [0.777]"),
        r"section \[run\]: `save_at` must hold multiples of ds = .*, got 0\.777;",
    ),
    "both ways of saving": (
        ("ds = 0.25", "ds = 0.25\nsave_every = 0.5"),
        r"section \[run\]: `save_at` and `save_every` must not both be given;",
    ),
    "saving interval": (
        ("save_at = [0.5, 1.0]", "save_every = 0.0"),
        r"section \[run\]: `save_every` must be positive, got 0\.",
    ),
    "name of a file": (
        ("[run]", '[output]\nname = "../result"\n[run]'),
        r"section \[output\]: `name` must be the name of a file without folders, got "
        r"'\.\./result'\.",
    ),
    "format of a file": (
        ("[run]", '[output]\nformat = "csv"\n[run]'),
        r"section \[output\]: `format` must be 'netcdf' or 'zarr', got 'csv'\.",
    ),
    "table given as a list": (
        ("[model]", "[[model]]"),
        r"section \[model\] must be a table, got",
    ),
    "process beside a model": (
        ("[grid]", PROCESS + "[grid]"),
        r"\[process\] must stand alone, got \[potential\], \[model\], \[curve\] beside "
        r"it; remove one or the other\.",
    ),
    "process out of range": (
        (TEXT, PROCESS.replace("16.0", "-16.0") + WITHOUT_MODEL),
        r"section \[process\]: `noise` must be non-negative and finite, got -16\.",
    ),
    "no model": (
        ("[model]\nnoise = 1.0\n", ""),
        r"the sections \[potential\] and \[model\], or \[process\], must be given, got "
        r"\[potential\], \[curve\]\.",
    ),
    "nothing that says what to solve": (
        (TEXT, WITHOUT_MODEL),
        r"or \[process\], must be given, got none of them\.",
    ),
}


@pytest.mark.parametrize(("change", "message"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_named(change, message):
    assert change[0] in TEXT
    with pytest.raises(ConfigurationError, match=message):
        read_config(TEXT.replace(*change)).build()


def test_all_mistakes_are_told_at_once():
    text = TEXT.replace("noise", "noice").replace("speed", "spead")
    with pytest.raises(ConfigurationError) as caught:
        read_config(text)
    assert "did you mean `noise`?" in str(caught.value)
    assert "did you mean `speed`?" in str(caught.value)


def test_an_unlikely_value_is_a_warning_when_the_run_is_built():
    config = read_config(PROCESS.replace("0.01\n", "0.1\n") + WITHOUT_MODEL)
    with pytest.warns(UserWarning, match="millimetres given instead of metres"):
        config.build()


def test_a_slip_of_units_is_an_error():
    text = PROCESS.replace("0.01\n", "10.0\n") + WITHOUT_MODEL
    message = r"section \[process\]: `sigma1` .* got 10; .*millimetres given instead"
    with pytest.raises(ConfigurationError, match=message):
        read_config(text)


def test_what_is_not_toml_is_refused_with_the_line(tmp_path):
    path = tmp_path / "run.toml"
    path.write_text("[run\ns_end = 1.0\n")
    message = r"configuration `.*run\.toml` is not valid TOML: .*line 1"
    with pytest.raises(ConfigurationError, match=message):
        load_config(path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigurationError, match=r"it is not text in UTF-8\."):
        load_config(path)


def test_a_file_that_is_not_there_or_a_folder_is_refused(tmp_path):
    message = (
        r"`config` must be an existing TOML file, got `.*none\.toml`; leave it out"
    )
    with pytest.raises(ConfigurationError, match=message):
        load_config(tmp_path / "none.toml")
    with pytest.raises(ConfigurationError, match=r"got the folder `.*`; name a file"):
        load_config(tmp_path)


def test_a_file_that_cannot_be_read_is_refused(tmp_path):
    path = tmp_path / "loop.toml"
    path.symlink_to(path)
    with pytest.raises(ConfigurationError, match=r"cannot be read: .*symbolic links"):
        load_config(path)


def test_an_unknown_example_is_refused():
    message = r"`example` must be one of laydown, spunbond, got 'spunbnd'; did you mean"
    with pytest.raises(ConfigurationError, match=message):
        example_path("spunbnd")


def test_the_nearest_name_is_suggested_and_the_first_of_equals():
    assert suggestion("sigma", ["kind", "sigma1", "sigma2"]) == (
        "; did you mean `sigma1`?"
    )
    assert suggestion("xyz", ["kind", "sigma1"]) == "."
    assert suggestion("xyz", []) == "."
