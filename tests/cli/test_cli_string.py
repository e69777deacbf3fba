"""`fpsolve string` says what `fibre.lay_down` says; a mistake leaves no file."""

from contextlib import contextmanager

import pytest
from command_line import assert_mistake, files

import fpsolve as fp
from fpsolve import fibre
from fpsolve.cli.config import (
    STRING_EXAMPLE,
    StringConfig,
    example_path,
    load_config,
    read_config,
)
from fpsolve.cli.errors import INTERRUPTED

SPUN = """
[fibre]
length = 0.2
diameter = 2e-4
density = 1000.0
youngs_modulus = 1e8
n_edges = 10

[nozzle]
position = [0.0, 0.0, 0.2]
direction = [0.1, 0.03, -1.0]
speed = 1.0

[belt]
speed = 0.3

[air]
velocity = [0.0, 0.0, -1.0]
k = 0.05
dissipation = 1.0

[turbulence]
kolmogorov_constant = 1.2

[steps]
t_end = 0.3
n_steps = 60

[output]
name = "spun"
"""


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "spun.toml"
    path.write_text(SPUN)
    return path


def test_a_fibre_on_the_belt_is_that_of_the_library(fpsolve, config, tmp_path):
    result = fpsolve("string", config, "--seed", 3, "--out", "out")
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "out") == ["spun-curve.nc", "spun.nc", "spun.png"]
    found = fp.load(tmp_path / "out" / "spun.nc")
    string = fibre.String(
        0.2, 2e-4, 1000.0, 1e8, n_edges=10, end=fibre.Free(),
        start=fibre.Nozzle((0.0, 0.0, 0.2), (0.1, 0.03, -1.0), 1.0),
    )  # fmt: skip
    expected = fibre.lay_down(
        string, 0.3, 60, belt=fibre.Belt(0.3), turbulence=fibre.TurbulentForce(1.2),
        air=fibre.AirFlow((0.0, 0.0, -1.0), k=0.05, dissipation=1.0), seed=3,
        estimate_error=False,
    )  # fmt: skip
    assert fp.compare(found, expected).equal
    curve = fp.load(tmp_path / "out" / "spun-curve.nc")
    assert fp.compare(curve, expected.laid_curve()).equal
    assert "0.3 m at 1 m/s in 0.3 s" in result.stdout
    assert f"{curve.length:.4g} m, every 0.02 m" in result.stdout


def test_a_belt_with_friction_is_told_and_so_is_the_pull_at_the_nozzle(
    fpsolve, config, tmp_path
):
    config.write_text(SPUN.replace("speed = 0.3", "speed = 0.3\nfriction = 0.5"))
    words = ["--t-end", 0.2, "--n-steps", 40, "--no-figures", "--out", "out"]
    result = fpsolve("string", config, *words)
    assert result.exit_code == 0, result.output
    assert "0.3 m/s, friction 0.5" in result.stdout
    found = fp.load(tmp_path / "out" / "spun.nc")
    assert found.belt == fibre.Belt(0.3, friction=0.5)
    # Something lies, and rubs.
    assert len(found.landed) > 3
    assert f"{found.nozzle_tension[1:].mean():.3g} N on average" in result.stdout


def test_noise_that_is_too_strong_for_the_steps_is_a_mistake_that_is_told(
    fpsolve, config, tmp_path
):
    config.write_text(SPUN.replace("k = 0.05", "k = 500.0"))
    words = ["--t-end", 3.0, "--n-steps", 60, "--out", "out"]
    said = "`n_steps`, in which they turn by"
    assert_mistake(fpsolve("string", config, *words), said, code=1)
    assert not (tmp_path / "out").exists()


def test_the_configuration_that_was_used_is_kept(fpsolve, config, tmp_path):
    words = ["--t-end", 0.1, "--n-steps", 20, "--no-figures", "--out", "out"]
    result = fpsolve("string", config, *words)
    assert result.exit_code == 0, result.output
    # In a tenth of a second nothing reaches the belt but the end of the fibre.
    assert "no curve on the belt: `skip` must leave five nodes" in result.stdout
    assert files(tmp_path / "out") == ["spun.nc"]
    about = fp.load(tmp_path / "out" / "spun.nc").provenance
    used = read_config(about["configuration"], kind=StringConfig)
    asked = load_config(config, StringConfig)
    assert used == asked.changed("steps", t_end=0.1, n_steps=20)
    assert about["command"] == f"fpsolve string {config} --t-end 0.1 --n-steps 20"


def test_after_ctrl_c_the_same_command_goes_on(fpsolve, config, tmp_path, monkeypatch):
    @contextmanager
    def pressed():
        def report(n_done, n_total, t):
            if n_done == 20:
                raise KeyboardInterrupt

        yield report

    words = ("string", config, "--no-figures", "--out", "out")
    with monkeypatch.context() as patch:
        patch.setattr("fpsolve.cli.progress.progress_bar", pressed)
        result = fpsolve(*words)
    assert result.exit_code == INTERRUPTED
    part = tmp_path / "out" / "spun-checkpoint.nc"
    assert "interrupted; the same command goes on from" in result.stderr
    assert fp.load(part).t.size == 21
    assert fpsolve(*words).exit_code == 0
    assert not part.exists()
    assert fpsolve(*words[:-1], "whole").exit_code == 0
    both = (fp.load(tmp_path / name / "spun.nc") for name in ("out", "whole"))
    assert fp.compare(*both).equal


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("speed = 1.0", "speed = -1.0", "section [nozzle]"),
        (
            "velocity = [0.0, 0.0, -1.0]",
            "",
            "one of `velocity` and `file` must be given",
        ),
        ("velocity = [0.0, 0.0, -1.0]", 'file = "no.csv"', "no.csv"),
        ("n_edges = 10", "n_edge = 10", "n_edges"),
        ("length = 0.2", "length = 0.3", "`shape` must not be below the belt"),
        ("k = 0.05", "k = 1e-9", "no inertial range"),
        ("n_steps = 60", "n_steps = 0", "`n_steps` must be at least 1"),
    ],
)
def test_a_mistake_is_told_in_its_section_and_leaves_no_file(
    fpsolve, config, tmp_path, old, new, said
):
    config.write_text(SPUN.replace(old, new))
    assert_mistake(fpsolve("string", config, "--out", "out"), said)
    assert not (tmp_path / "out").exists()


def test_the_packaged_example_is_laid_in_turbulent_air():
    string, arguments = load_config(example_path(STRING_EXAMPLE), StringConfig).build()
    assert string.start.position[2] - string.length > arguments["belt"].height
    assert arguments["turbulence"].kolmogorov_constant == 1.2
    # The noise of a step is drawn anew, in steps of a millisecond.
    assert arguments["t_end"] / arguments["n_steps"] == pytest.approx(1e-3)
