"""Configurations of paths say what they mean, and wrong ones what was meant."""

import inspect

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.cli.config import (
    PATHS_EXAMPLE,
    PathsConfig,
    RunConfig,
    example_path,
    load_config,
    read_config,
)
from fpsolve.cli.config.paths import PathsSection
from fpsolve.errors import ConfigurationError
from fpsolve.paths import EquilibriumLaw, GaussianLaw, PointLaw

TEXT = """
[potential]
kind = "quadratic"
sigma1 = 1.0

[model]
noise = 1.0

[curve]
kind = "moving_belt"
speed = 0.1

[start]
kind = "gaussian"
mean = [0.5, 0.0]
variance = 0.25

[paths]
n_paths = 7
s_end = 1.0
ds = 0.25
seed = 3
save_at = [0.5, 1.0]

[histogram]
half_width = 6.0
shape = [16, 16, 8]
"""
PROCESS = """
[process]
sigma1 = 0.01
sigma2 = 0.02
noise = 16.0
speed_ratio = 0.1
spinning_speed = 50.0
"""
START = TEXT[TEXT.index("[start]") : TEXT.index("[paths]")]
HISTOGRAM = TEXT[TEXT.index("[histogram]") :]


def read(text):
    return read_config(text, kind=PathsConfig)


def test_a_configuration_builds_what_python_would():
    problem = read(TEXT).build()
    assert problem.model == fp.LayDownModel(
        fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1)
    )
    assert problem.arguments == {
        "n_paths": 7,
        "s_end": 1.0,
        "ds": 0.25,
        "seed": 3,
        "initial": GaussianLaw((0.5, 0.0), 0.25),
        "save_at": (0.5, 1.0),
        "method": "splitting",
        "keep": True,
        "histogram": fp.PhaseSpaceGrid(6.0, (16, 16, 8)),
    }
    paths = fp.sample_paths(problem.model, **problem.arguments)
    np.testing.assert_array_equal(paths.s, [0.5, 1.0])


def test_defaults_are_those_of_the_sampler():
    defaults = inspect.signature(fp.sample_paths).parameters
    for name in ("method", "keep", "seed"):
        assert PathsSection.model_fields[name].default == defaults[name].default


@pytest.mark.parametrize("method", ["splitting", "euler_maruyama", "heun"])
def test_every_method_can_be_asked_for(method):
    config = read(TEXT.replace("seed = 3", f'seed = 3\nmethod = "{method}"'))
    model, arguments = config.build()
    assert fp.sample_paths(model, **arguments).method == method


@pytest.mark.parametrize(
    ("start", "law"),
    [
        ("", PointLaw()),
        ('[start]\nkind = "point"\n', PointLaw()),
        (
            '[start]\nkind = "point"\nxi = [1.0, 2.0]\nalpha = 0.5\n',
            PointLaw((1.0, 2.0), 0.5),
        ),
        (
            '[start]\nkind = "gaussian"\nvariance = [[1.0, 0.5], [0.5, 1.0]]\n',
            GaussianLaw(variance=((1.0, 0.5), (0.5, 1.0))),
        ),
        ('[start]\nkind = "equilibrium"\n', EquilibriumLaw(fp.QuadraticPotential())),
    ],
    ids=["left out", "origin", "directed point", "matrix", "equilibrium"],
)
def test_starts_are_laws(start, law):
    assert read(TEXT.replace(START, start)).build().arguments["initial"] == law


def test_a_process_in_si_units_takes_the_place_of_the_model():
    problem = read(PROCESS + TEXT[TEXT.index("[start]") :]).build()
    assert problem.model == fp.Process(0.01, 0.02, 16.0, 0.1, 50.0).model


def test_without_a_histogram_none_is_collected():
    assert "histogram" not in read(TEXT.replace(HISTOGRAM, "")).build().arguments


def test_a_histogram_has_cells_for_those_who_name_none():
    config = read(TEXT.replace("shape = [16, 16, 8]", ""))
    assert config.build().arguments["histogram"].shape == (64, 64, 32)
    assert "shape = [64, 64, 32]" in config.to_toml()


def test_saving_at_an_interval_includes_both_ends():
    config = read(TEXT.replace("save_at = [0.5, 1.0]", "save_every = 0.75"))
    assert config.build().arguments["save_at"] == (0.0, 0.75, 1.0)
    config = read(TEXT.replace("save_at = [0.5, 1.0]", ""))
    assert config.build().arguments["save_at"] == (1.0,)


def test_a_seed_that_is_not_given_is_drawn_and_written_down():
    config = read(TEXT.replace("seed = 3\n", ""))
    first, second = config.build(), config.build()
    assert first.arguments["seed"] != second.arguments["seed"]
    written = read(config.resolved(first).to_toml())
    assert written.build().arguments["seed"] == first.arguments["seed"]


def test_writing_and_reading_gives_the_same_configuration():
    config = read(TEXT)
    assert read(config.to_toml()) == config


def test_the_example_is_quick_and_survives_writing():
    config = load_config(example_path(PATHS_EXAMPLE), PathsConfig)
    assert read(config.to_toml()) == config
    assert config.build().model.belt_speed == 0.1
    # Seven million path-steps, a second of work, and a file that goes into a mail.
    steps = config.paths.n_paths * config.paths.s_end / config.paths.ds
    assert steps < 1e7


# What replaces what in TEXT, and what is then said.
WRONG = {
    "misspelt key": (
        ("n_paths = 7", "n_path = 7"),
        r"section \[paths\]: `n_path` is not a key; did you mean `n_paths`\? Keys are ",
    ),
    "misspelt section": (
        ("[start]", "[strat]"),
        r"unknown section \[strat\]; did you mean \[start\]\? Sections are \[potential",
    ),
    "section of a run": (
        ("[start]", "[initial]"),
        r"unknown section \[initial\]; it belongs to the configuration of `fpsolve "
        r"run`\.",
    ),
    "misspelt kind": (
        ('"gaussian"', '"gausian"'),
        r"section \[start\]: `kind` must be one of 'point', 'gaussian', 'equilibrium', "
        r"got 'gausian'; did you mean 'gaussian'\?",
    ),
    "misspelt key of a start": (
        ("variance", "varience"),
        r"section \[start\]: `varience` is not a key of the kind 'gaussian'; did you "
        r"mean `variance`\?",
    ),
    "misspelt method": (
        ("seed = 3", 'method = "eulr"'),
        r"section \[paths\]: `method` must be 'splitting', 'euler_maruyama' or 'heun', "
        r"got 'eulr'\.",
    ),
    "no step": (("ds = 0.25\n", ""), r"section \[paths\]: `ds` must be given\."),
    "no paths": (
        ("n_paths = 7", "n_paths = 0"),
        r"section \[paths\]: `n_paths` must be at least 1, got 0\.",
    ),
    "half a path": (
        ("n_paths = 7", "n_paths = 0.5"),
        r"section \[paths\]: `n_paths` must be an integer, got 0\.5\.",
    ),
    "negative seed": (
        ("seed = 3", "seed = -3"),
        r"section \[paths\]: `seed` must be at least 0, got -3\.",
    ),
    "step": (
        ("ds = 0.25", "ds = 0.3"),
        r"section \[paths\]: `ds` must divide the span 1 into whole steps, got 0\.3; "
        r"use ds = 0\.25\.",
    ),
    "saving point": (
        ("[0.5, 1.0]", "[0.6]"),
        r"section \[paths\]: `save_at` must hold multiples of ds = 0\.25 .*, got 0\.6;",
    ),
    "both ways of saving": (
        ("seed = 3", "seed = 3\nsave_every = 0.5"),
        r"section \[paths\]: `save_at` and `save_every` must not both be given;",
    ),
    "law": (
        ("variance = 0.25", "variance = 0.25\nconcentration = 2.0"),
        r"section \[start\]: `angle` must be given when `concentration` is positive",
    ),
    "law that does not exist": (
        (
            TEXT,
            TEXT.replace('"quadratic"\nsigma1 = 1.0', '"free"').replace(
                START, '[start]\nkind = "equilibrium"\n'
            ),
        ),
        r"section \[start\]: `potential` .*FreePotential\(\)",
    ),
    "box": (
        ("half_width = 6.0", "half_width = -6.0"),
        r"section \[histogram\]: `half_width` must be positive and finite, got -6\.",
    ),
    "cells": (
        ("[16, 16, 8]", "[16, 16, 2]"),
        r"section \[histogram\]: `shape\[2\] \(n_alpha\)` must be at least 4, got 2\.",
    ),
    "process beside a model": (
        ("[start]", PROCESS + "[start]"),
        r"\[process\] must stand alone, got \[potential\], \[model\], \[curve\] beside",
    ),
    "no model": (
        ("[model]\nnoise = 1.0\n", ""),
        r"the sections \[potential\] and \[model\], or \[process\], must be given, got",
    ),
}


@pytest.mark.parametrize(("change", "message"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_named(change, message):
    assert change[0] in TEXT
    with pytest.raises(ConfigurationError, match=message):
        read(TEXT.replace(*change)).build()


def test_a_configuration_for_the_other_command_is_one_sentence():
    run = example_path("laydown").read_text("utf-8")
    for text, kind, command in (
        (TEXT, RunConfig, "fpsolve paths"),
        (run, PathsConfig, "fpsolve run"),
    ):
        message = f"its sections are those of `{command}`; give it to that command"
        with pytest.raises(ConfigurationError, match=message) as caught:
            read_config(text, kind=kind)
        assert "\n" not in str(caught.value)


SMOOTH = TEXT.replace("noise = 1.0", "noise = 1.0\nrelaxation_length = 0.5")


def test_a_relaxation_length_in_the_section_of_the_model_makes_it_smooth():
    expected = fp.SmoothLayDownModel(
        fp.QuadraticPotential(), 0.5, 1.0, fp.MovingBelt(0.1)
    )
    assert read(SMOOTH).build().model == expected
    by_curvature = SMOOTH.replace("noise = 1.0", "curvature_noise = 2.0")
    assert read(by_curvature).build().model == expected
    written = read(read(SMOOTH).to_toml())
    assert written.build().model == expected
    of_process = read(
        PROCESS + "relaxation_length = 5e-3\n" + TEXT[TEXT.index("[paths]") :]
    )
    assert of_process.build().model.relaxation_length == 0.5


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            ("relaxation_length = 0.5", ""),
            "`relaxation_length` must be given with `curv",
        ),
        (("curvature_noise = 2.0", ""), "exactly one of `noise` and `curvature_noise`"),
        (("= 0.5", "= -0.5"), "`relaxation_length` must be positive"),
    ],
)
def test_half_a_smooth_model_is_refused(change, message):
    text = SMOOTH.replace("noise = 1.0", "curvature_noise = 2.0").replace(*change, 1)
    with pytest.raises(ConfigurationError, match=rf"section \[model\]: {message}"):
        read(text).build()


def test_the_noise_of_a_model_must_be_given():
    with pytest.raises(ConfigurationError, match=r"section \[model\]: `noise` must be"):
        read(TEXT.replace("noise = 1.0", "")).build()
