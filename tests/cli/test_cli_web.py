"""`fpsolve web` lays what a file or options ask for; a mistake leaves no file."""

import signal
from contextlib import contextmanager

import numpy as np
import pytest
from command_line import HANGS, assert_mistake, command_waiting_at, files

import fpsolve as fp
from fpsolve.cli.config import WEB_EXAMPLE, WebConfig, example_path, load_config
from fpsolve.errors import MemoryLimitError

PROCESS = """
[process]
sigma1 = 0.005
sigma2 = 0.005
noise = 15.0
speed_ratio = 0.1
spinning_speed = 50.0

[web]
width = 0.02
length = 0.04
pixel = 1e-3
spacing = 2e-3
titer = 1.5e-4
seed = 5
zones = [1e-3, 2e-3]

[output]
name = "few"
"""
NOZZLE = """
[potential]
kind = "linear"

[model]
noise = 1.0
relaxation_length = 0.5

[curve]
kind = "rotating_nozzle"
speed = 0.2
radius = 1.0
angular_speed = 0.5

[web]
width = 1.0
length = 2.0
pixel = 0.5
positions = [0.0, 0.5, 1.0]
phases = "in phase"
"""
SMALL = ("--width", 2, "--length", 2, "--pixel", 0.5, "--spacing", 0.5)


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "few.toml"
    path.write_text(PROCESS)
    return path


def done(result):
    assert result.exit_code == 0, result.output
    return result


def same(web, other):
    for name in ("length_density", "orientation_11", "orientation_12"):
        np.testing.assert_array_equal(getattr(web, name), getattr(other, name))


def test_a_web_is_that_of_the_library_with_its_configuration(fpsolve, config, tmp_path):
    shown = done(fpsolve("web", config, "--out", "out", "--no-figures")).stdout
    assert files(tmp_path / "out") == ["few.nc", "few.toml"]
    for name in ("few.nc", "few.toml"):
        assert f"out/{name}" in shown
    process = fp.Process(0.005, 0.005, 15.0, 0.1, 50.0)
    expected = fp.lay_web(
        process, width=0.02, length=0.04, pixel=1e-3, spacing=2e-3, titer=1.5e-4, seed=5
    )
    found = fp.load(tmp_path / "out" / "few.nc")
    same(found, expected)
    assert found.process == process
    assert found.call.function == "lay_web"
    written = (tmp_path / "out" / "few.toml").read_text("utf-8")
    assert found.provenance["configuration"] == written


def test_what_is_printed_are_the_measures_of_the_web(fpsolve, config, tmp_path):
    shown = done(fpsolve("web", config, "--out", "out", "--no-figures")).stdout
    web = fp.load(tmp_path / "out" / "few.nc")
    assert "0.02 x 0.04 m, across x along" in shown
    assert "5 (from the configuration)" in shown
    assert "units of 5 mm" in shown
    # 1.5e-4 g/m over v d = 0.1 times 2 mm.
    assert web.base_weight == pytest.approx(0.75, rel=1e-14)
    assert "0.75 g/m²" in shown
    for zone, text in ((1e-3, "1 mm"), (2e-3, "2 mm")):
        row = next(line for line in shown.splitlines() if f" {text} " in line)
        found, _, error = row.split()[2:5]
        expected = web.coefficient_of_variation(zone)
        # Two digits of the error are printed, and as many places of the value.
        unit = 10.0 ** -len(error.partition(".")[2])
        assert abs(float(found) - 100 * expected) <= 0.5001 * unit
        assert abs(float(error) - 100 * expected.standard_error) <= 0.5001 * unit
    assert "MD/CD" in shown
    share = 100 * web.outside_length / web.laid_length
    assert f"{share:.1f} % of what was laid" in shown


def test_figures_and_exports_are_written_as_asked(fpsolve, config, tmp_path, undrawn):
    tifffile = pytest.importorskip("tifffile")
    asked = ("png", "tiff", "csv", "vtp")
    exports = [word for name in asked for word in ("--export", name)]
    done(fpsolve("web", config, "--out", "out", *exports))
    left = files(tmp_path / "out")
    assert {"few.nc", "few.toml", *(f"few.{name}" for name in asked)} <= set(left)
    assert {"few-light.png", "few-variation.png"} <= set(left)
    web = fp.load(tmp_path / "out" / "few.nc")
    image = tifffile.imread(tmp_path / "out" / "few.tiff")
    assert image.dtype == np.uint16
    one = web.mass_density.max() / 65535
    np.testing.assert_allclose(image * one, web.mass_density, rtol=0, atol=0.51 * one)
    for name, write in (("csv", web.to_csv), ("vtp", web.to_vtp)):
        again = write(tmp_path / f"again.{name}").read_bytes()
        assert (tmp_path / "out" / f"few.{name}").read_bytes() == again
    used = load_config(tmp_path / "out" / "few.toml", WebConfig)
    assert used.web.exports == asked


def test_options_of_the_model_make_a_web_without_units(fpsolve, tmp_path):
    words = ("--potential", "linear", "--noise", 0.8, "--relaxation-length", 0.5)
    options = (*words, "--belt-speed", 0.2, *SMALL, "--seed", 3, "--periodic")
    shown = done(fpsolve("web", *options, "--no-figures")).stdout
    assert "m^-1/2" not in shown
    assert "base weight" not in shown
    model = fp.SmoothLayDownModel(fp.LinearPotential(), 0.5, 0.8, fp.MovingBelt(0.2))
    expected = fp.lay_web(
        model, width=2.0, length=2.0, pixel=0.5, spacing=0.5, seed=3, periodic=True
    )
    same(fp.load(tmp_path / "results" / "web.nc"), expected)


def test_a_nozzle_of_a_file_is_laid_and_options_take_the_place_of_keys(
    fpsolve, config, tmp_path
):
    config.write_text(NOZZLE)
    words = ("--positions", "random", "--spacing", 0.5, "--seed", 4, "--ds", 0.125)
    done(fpsolve("web", config, *words, "--no-figures"))
    model = fp.SmoothLayDownModel(
        fp.LinearPotential(), 0.5, 1.0, fp.RotatingNozzle(0.2, 1.0, 0.5)
    )
    expected = fp.lay_web(
        model, width=1.0, length=2.0, pixel=0.5, spacing=0.5, positions="random",
        phases="in phase", ds=0.125, seed=4,
    )  # fmt: skip
    same(fp.load(tmp_path / "results" / "web.nc"), expected)
    assert "ds = 0.125" in (tmp_path / "results" / "web.toml").read_text("utf-8")


def test_a_web_is_repeated_from_what_was_written_with_its_drawn_seed(
    fpsolve, config, tmp_path
):
    config.write_text(PROCESS.replace("seed = 5\n", ""))
    shown = done(fpsolve("web", config, "--out", "first", "--no-figures")).stdout
    assert "(drawn)" in shown
    done(fpsolve("web", tmp_path / "first" / "few.toml", "--out", "second"))
    first, second = (
        fp.load(tmp_path / name / "few.nc") for name in ("first", "second")
    )
    same(first, second)
    assert fp.compare(first, fp.rerun(first)).equal


def test_a_web_too_small_for_an_error_says_so(fpsolve, tmp_path):
    words = (*SMALL, "--width", 1, "--noise", 1, "--seed", 1, "--zone", 1)
    shown = done(fpsolve("web", *words, "--no-figures")).stdout
    assert "(error unknown)" in shown


def test_the_example_is_a_spunbond_process_in_si_units():
    config = load_config(example_path(WEB_EXAMPLE), WebConfig)
    problem = config.build()
    assert problem.model == fp.Process(0.005, 0.005, 15.0, 0.1, 50.0)
    plan = problem.order.plan
    # A second of work, and a file that goes into a mail.
    assert plan.n_fibres * plan.ensemble.schedule.n_steps < 1e7
    assert np.prod(plan.window.shape) <= 1e5


def test_without_a_file_the_example_is_laid(fpsolve, tmp_path):
    words = ("--width", 0.01, "--length", 0.01, "--pixel", 5e-3, "--zone", 5e-3)
    shown = done(fpsolve("web", *words, "--no-figures")).stdout
    assert "A = 15 m^-1/2" in shown
    assert files(tmp_path / "results") == ["web.nc", "web.toml"]


def test_options_of_the_model_are_refused_beside_a_file(fpsolve, config, tmp_path):
    result = fpsolve("web", config, "--noise", 1, "--sigma1", 1)
    assert_mistake(result, "`--noise`, `--sigma1` must not be given beside a file")
    assert files(tmp_path) == ["few.toml"]


def test_pixels_beyond_memory_are_refused_before_a_fibre_is_laid(
    fpsolve, config, tmp_path
):
    words = ("--pixel", 1e-8, "--width", 1.0, "--length", 1.0)
    result = fpsolve("web", config, *words)
    assert result.exit_code == 1, result.output
    assert "use larger pixels" in result.stderr
    assert files(tmp_path) == ["few.toml"]
    config.write_text(PROCESS.replace("pixel = 1e-3", "pixel = 1e-10"))
    with pytest.raises(MemoryLimitError, match=r"needs .*iB"):
        load_config(config, WebConfig).build()


def test_a_picture_that_cannot_be_is_refused_before_a_fibre_is_laid(
    fpsolve, config, tmp_path
):
    result = fpsolve("web", config, "--pixel", 2e-3, "--zone", 4e-3, "--export", "png")
    assert_mistake(result, "pixels along a side of its picture, got 10 × 20")
    assert files(tmp_path) == ["few.toml"]


def test_a_name_that_is_taken_is_refused_before_a_fibre_is_laid(
    fpsolve, config, tmp_path
):
    (tmp_path / "out" / "few.csv").mkdir(parents=True)
    result = fpsolve("web", config, "--out", "out", "--export", "csv")
    assert_mistake(result, "few.csv")
    assert files(tmp_path / "out") == ["few.csv"]


def test_an_interrupt_leaves_no_file(fpsolve, config, tmp_path, monkeypatch):
    @contextmanager
    def bar():
        def report(n_done, n_total, s):
            raise KeyboardInterrupt

        yield report

    monkeypatch.setattr("fpsolve.cli.progress.progress_bar", bar)
    assert_mistake(fpsolve("web", config, "--out", "out"), "interrupted", 130)
    assert files(tmp_path) == ["few.toml"]


@pytest.mark.processes
@pytest.mark.nightly
def test_a_signal_stops_the_laying_and_leaves_no_file(config, tmp_path):
    process = command_waiting_at(1, "web", config, cwd=tmp_path)
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=HANGS)
    assert process.returncode == 130, stderr
    assert "interrupted" in stderr
    assert "Traceback" not in stderr
    assert files(tmp_path) == ["few.toml"]
