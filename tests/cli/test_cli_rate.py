"""`fpsolve rate` and `fpsolve spectrum` compute, write, draw and say what is wrong."""

import numpy as np
import pytest
import xarray as xr
from command_line import assert_mistake, files
from matplotlib.image import imread

from fpsolve.cli.rate import rate
from fpsolve.cli.spectrum import spectrum


@pytest.fixture
def call(fpsolve):
    """Call a command in an empty folder; returns what click recorded."""
    return lambda command, *words: fpsolve(command.__name__, *words)


def test_a_quick_study_is_written_printed_and_drawn(call, tmp_path):
    words = ("--quick", "--noise", 1.2, "--noise", 2, "--potential", "quadratic",
             "--part", "relaxation", "--part", "gap", "--workers", 0,
             "--out", "out")  # fmt: skip
    result = call(rate, *words)
    assert result.exit_code == 0, result.output
    assert "B = (ξ₁² + ξ₂²)/2" in result.stdout
    for column in ("∫ H ds", "½ rate of H", "spectral gap", "proven"):
        assert column in result.stdout
    names = [
        "rate-cases",
        "rate-integral.png",
        "rate-quadratic.nc",
        "rate-quadratic.png",
    ]
    assert files(tmp_path / "out") == names
    for name in names[1:]:
        assert f"out/{name}" in result.stdout
    with xr.open_dataset(tmp_path / "out" / "rate-quadratic.nc") as dataset:
        assert dataset.sizes["noise"] == 2
        np.testing.assert_allclose(
            dataset["gap"], dataset["entropy_rate"] / 2, rtol=1e-2
        )
    assert imread(tmp_path / "out" / "rate-quadratic.png").shape[1] == 1400
    # The second time everything is read.
    assert len(files(tmp_path / "out" / "rate-cases")) == 4
    assert call(rate, *words).exit_code == 0


def test_failed_cases_are_told_and_are_exit_code_one_if_nothing_else_is(
    call, monkeypatch
):
    def broken(potential, noise, tolerance):
        raise MemoryError("no room")

    monkeypatch.setattr("fpsolve.studies.rates.cases.PARTS", {"gap": broken})
    monkeypatch.setattr(
        "fpsolve.studies.rates.rate_versus_noise.PARTS", {"gap": broken}
    )
    result = call(
        rate, "--noise", 1, "--potential", "linear", "--workers", 0, "--no-figures"
    )
    assert result.exit_code == 1
    assert "warning: gap at A = 1 failed: MemoryError: no room" in result.stderr
    assert "Traceback" not in result.output


def test_ctrl_c_writes_what_is_finished(call, tmp_path, monkeypatch):
    def interrupted(potential, noise, tolerance):
        raise KeyboardInterrupt

    monkeypatch.setattr("fpsolve.studies.rates.cases.PARTS", {"gap": interrupted})
    result = call(
        rate, "--noise", 1, "--potential", "quadratic", "--part", "gap", "--workers", 0
    )
    assert_mistake(result, "interrupted; what was finished is kept", code=130)
    assert "rate-quadratic-interrupted.nc" in files(tmp_path / "results")


def test_bad_input_of_a_study_is_one_line_and_exit_code_two(call, tmp_path):
    assert_mistake(call(rate, "--noise", 0), "`noises` must be positive and finite")
    assert_mistake(call(rate, "--potential", "free"), "`potential` must confine, got")
    assert_mistake(
        call(rate, "--potential", "cubic"),
        "`--potential` must be one of quadratic, lin",
    )
    assert_mistake(call(rate, "--part", "rest"), "`parts` must be among relaxation")
    assert_mistake(
        call(rate, "--potential", "quadratic", "--tolerance", -1),
        "`tolerance` must lie",
    )
    assert files(tmp_path) == []


def test_eigenvalues_are_printed_written_and_drawn(call, tmp_path):
    result = call(spectrum, "--noise", 1, "-n", 4, "--tolerance", 1e-8, "--out", "out")
    assert result.exit_code == 0, result.output
    assert "-0.37429405" in result.stdout
    assert "M = ±1" in result.stdout
    assert "gap 0.37429405" in result.stdout
    assert files(tmp_path / "out") == ["spectrum.nc", "spectrum.png"]
    with xr.open_dataset(tmp_path / "out" / "spectrum.nc") as dataset:
        assert dataset["real"].values[0] == pytest.approx(-0.37429405, abs=1e-8)
        assert dataset["sector"].values[0] == "M = ±1"
    assert imread(tmp_path / "out" / "spectrum.png").shape[1] == 680


def test_other_potentials_and_belts_have_spectra_too(call):
    words = ("--no-figures", "-n", 1, "--tolerance", 1e-4, "--noise", 3)
    steep = call(spectrum, "--potential", "power", "--exponent", 4, *words)
    assert steep.exit_code == 0, steep.output
    belt = call(spectrum, "--belt-speed", 0.1, "--sigma2", 0.8, *words)
    assert belt.exit_code == 0, belt.output
    assert "τ(α) + 0.1 e₁" in belt.stdout


def test_bad_input_of_a_spectrum_is_one_line(call, tmp_path):
    assert_mistake(call(spectrum, "--noise", 0), "`noise` must be positive, got 0")
    assert_mistake(call(spectrum, "--potential", "free"), "`potential` must confine")
    tight = ("--noise", 0.3, "--tolerance", 1e-12, "--memory-limit", 1)
    result = call(spectrum, *tight)
    assert_mistake(result, "error: ", code=1)
    little = call(spectrum, "--noise", 0.3, "--work-limit", 1e4)
    assert_mistake(little, "where 1e+04 is allowed", code=1)
    assert files(tmp_path) == []
