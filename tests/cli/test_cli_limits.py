"""`fpsolve limits` prints, writes and draws, or says why not."""

import numpy as np
import pytest
import xarray as xr
from command_line import assert_mistake, files
from matplotlib.image import imread

from fpsolve.studies.limits.energy_law import SmoothedLaw

SMALL = ("small-noise", "--noise", "0.5", "--quick", "--workers", "0")
LARGE = ("large-noise", "--noise", "1.5", "--noise", "2", "--quick", "--workers", "0")


@pytest.fixture
def call(fpsolve):
    return lambda *words: fpsolve("limits", *words)


def test_little_noise_prints_writes_and_draws(call, tmp_path):
    result = call(*SMALL, "--out", str(tmp_path))
    assert result.exit_code == 0, result.output
    assert "distance" in result.output
    with xr.open_dataset(tmp_path / "small-noise-quadratic.nc") as found:
        assert list(found.noise.values) == [0.5]
        shown = f"{float(found.distance[0, 0]):.2g}"
    assert shown in result.output
    assert np.ptp(imread(tmp_path / "small-noise-quadratic.png")) > 0.5


def test_much_noise_prints_derived_and_fitted_orders(call, tmp_path):
    result = call(*LARGE, "--out", str(tmp_path), "--no-figures")
    assert result.exit_code == 0, result.output
    assert "derived" in result.output
    assert "joint_p1" in result.output
    with xr.open_dataset(tmp_path / "large-noise-quadratic.nc") as found:
        assert found.sizes["noise"] == 2
    assert not list(tmp_path.glob("*.png"))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["middle"], "`WHICH` must be large-noise, small-noise or both, got 'middle'"),
        (["--noise", "2"], "`--noise` must come with large-noise or small-noise"),
        (["small-noise", "--sigma2", "2"], "`potential` must be isotropic"),
        (["small-noise", "--potential", "free"], "must have a single well"),
        (["small-noise", "--noise", "-1"], "`noises` must be positive"),
        (["large-noise", "--noise", "nan"], "`noises` must be positive"),
        (["--potential", "cubic"], "`--potential` must be one of"),
    ],
)
def test_mistakes_end_with_a_message_and_leave_nothing(call, tmp_path, words, message):
    result = call(*words, "--out", str(tmp_path))
    assert_mistake(result, message)
    assert not files(tmp_path)


def test_cases_that_fail_are_named(call, tmp_path, monkeypatch):
    def broken(self, process):
        raise RuntimeError("no luck")

    monkeypatch.setattr(SmoothedLaw, "__init__", broken)
    result = call(*SMALL, "--out", str(tmp_path))
    assert result.exit_code == 1
    assert "no luck" in result.output + result.stderr
