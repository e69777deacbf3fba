"""`fpsolve predict` says what `predict_web` says; a mistake leaves no file."""

import numpy as np
import pytest
from command_line import assert_mistake, files
from web_numbers import choose_few_nodes

import fpsolve as fp

PROCESS = """
[process]
sigma1 = 0.005
sigma2 = 0.005
noise = 30.0
speed_ratio = 0.2
spinning_speed = 50.0

[web]
width = 0.02
length = 0.04
pixel = 1e-3
spacing = 2e-3
zones = [1e-2]

[output]
name = "few"
"""


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "few.toml"
    path.write_text(PROCESS)
    return path


def test_a_prediction_is_that_of_the_library_in_metres(
    fpsolve, config, tmp_path, monkeypatch
):
    # Of few nodes, whatever they miss: both have the same.
    choose_few_nodes(monkeypatch)
    # The zone of the file is as large as its window allows, the one asked for larger.
    words = ("--zone", 0.01, "--zone", 0.03, "--band", "0.01:0.02")
    result = fpsolve(
        "predict", config, *words, "--positions", "random", "--tolerance", 0.3,
        "--out", "out",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "out") == ["few-prediction.nc", "few-prediction.png"]
    found = fp.load(tmp_path / "out" / "few-prediction.nc")
    process = fp.Process(0.005, 0.005, 30.0, 0.2, 50.0)
    expected = fp.predict_web(
        process, spacing=2e-3, zones=[0.01, 0.03], positions="random",
        bands=[(0.01, 0.02)], tolerance=0.3,
    )  # fmt: skip
    np.testing.assert_array_equal(found.cv, expected.cv)
    np.testing.assert_array_equal(found.cloudiness, expected.cloudiness)
    assert found.length == 0.005
    for zone, cv, error in zip(found.zones, found.cv, found.errors, strict=True):
        row = next(
            one
            for one in result.stdout.splitlines()
            if one.strip().startswith(f"{zone:g} m")
        )
        assert f"{100 * cv:.5g} ± {100 * error:.1g} %" in row
    assert f"{found.machine_cross_ratio:.4f}" in result.stdout
    assert "0.01 to 0.02 m" in result.stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--spacing", 0), "`spacing` must be positive"),
        (("--spacing", "nan"), "`spacing` must be positive"),
        (("--positions", "hexagonal"), "`positions`"),
        (("--zone", "nan"), "`zones`"),
        (("--zone", 1e6), "`zones` must lie between"),
        (("--band", "1"), "`--band` must be SHORT:LONG"),
        (("--band", "0.02:0.01"), "`bands` must be pairs"),
        (("--tolerance", 0), "`tolerance` must be positive"),
        (("--noise", 1), "`--noise` must not be given beside a file"),
    ],
)
def test_a_mistake_is_told_and_leaves_no_file(
    fpsolve, config, tmp_path, words, message
):
    assert_mistake(fpsolve("predict", config, *words, "--out", "out"), message)
    assert not (tmp_path / "out").exists() or files(tmp_path / "out") == []


@pytest.mark.nightly
def test_a_smooth_fibre_of_a_file_is_predicted_in_metres(fpsolve, config, tmp_path):
    config.write_text(PROCESS.replace("[web]", "relaxation_length = 5e-4\n\n[web]"))
    result = fpsolve("predict", config, "--tolerance", 0.1, "--out", "out")
    assert result.exit_code == 0, result.output
    found = fp.load(tmp_path / "out" / "few-prediction.nc")
    assert found.model.relaxation_length == pytest.approx(0.1)
    assert found.length == 0.005
    process = fp.Process(0.005, 0.005, 30.0, 0.2, 50.0, relaxation_length=5e-4)
    expected = fp.predict_web(process, spacing=2e-3, zones=[0.01], tolerance=0.1)
    np.testing.assert_array_equal(found.cv, expected.cv)
