"""`fpsolve design` says what `design_web` says; a mistake leaves no file."""

import numpy as np
import pytest
from command_line import files
from known_webs import KnownWeb

import fpsolve as fp
from fpsolve import studies
from fpsolve.cli.config import (
    DESIGN_EXAMPLE,
    DesignConfig,
    example_path,
    load_config,
    read_config,
)
from fpsolve.studies.design import predictions

DESIGN = """
[process]
sigma1 = 0.005
sigma2 = 0.005
noise = 25.0
speed_ratio = 0.1
spinning_speed = 50.0

[design]
spacing = 2e-3
titer = 1e-4
zones = [0.01, 0.02]
largest = [0.0155, 0.0155]
free = ["noise", "speed_ratio", "spacing"]
n_webs = 0

[bounds]
noise = [15.0, 40.0]
speed_ratio = [0.05, 0.2]

[output]
name = "fast"
"""


@pytest.fixture
def config(tmp_path, monkeypatch):
    monkeypatch.setattr(predictions, "predict_web", KnownWeb())
    path = tmp_path / "fast.toml"
    path.write_text(DESIGN)
    return path


def test_a_design_is_that_of_the_library(fpsolve, config, tmp_path):
    result = fpsolve("design", config, "--front", 2, "--out", "out")
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "out") == ["fast.nc", "fast.png"]
    found = fp.load(tmp_path / "out" / "fast.nc")
    expected = studies.design_web(
        fp.Process(0.005, 0.005, 25.0, 0.1, 50.0), {0.01: 0.0155, 0.02: 0.0155},
        spacing=2e-3, titer=1e-4, free=["noise", "speed_ratio", "spacing"],
        bounds={"noise": (15.0, 40.0), "speed_ratio": (0.05, 0.2)},
        n_webs=0, front=2,
    )  # fmt: skip
    np.testing.assert_array_equal(found.values, expected.values)
    np.testing.assert_array_equal(found.front_cv, expected.front_cv)
    for name, value in zip(found.parameters, found.values, strict=True):
        said = f"{name} " in result.stdout and f"{value:.4g}" in result.stdout
        assert said == (name in found.free)
    assert f"{found.throughput:.4g} kg/h per metre" in result.stdout
    assert all(word in result.stdout for word in found.active)
    assert found.active


def test_the_configuration_that_was_used_is_kept(fpsolve, config, tmp_path):
    assert fpsolve("design", config, "--out", "out", "--no-figures").exit_code == 0
    assert files(tmp_path / "out") == ["fast.nc"]
    used = fp.load(tmp_path / "out" / "fast.nc").provenance["configuration"]
    assert read_config(used, kind=DesignConfig) == load_config(config, DesignConfig)


def test_a_target_out_of_reach_costs_one_line_and_no_file(fpsolve, config, tmp_path):
    config.write_text(DESIGN.replace("0.0155, 0.0155", "0.001, 0.0155"))
    result = fpsolve("design", config, "--out", "out")
    assert result.exit_code == 1
    assert "CV <= 0.001 of zones of 0.01 m cannot be met" in result.stderr
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_packaged_example_is_a_design_in_si_units():
    process, asked = load_config(example_path(DESIGN_EXAMPLE), DesignConfig).build()
    # The base weight that the packaged web has, 3 g/m².
    weight = asked["titer"] / (process.speed_ratio * asked["spacing"])
    assert weight == pytest.approx(3.0)
    assert asked["target"] == [[0.01, 0.07]]
    assert set(asked["bounds"]) == set(asked["free"])
