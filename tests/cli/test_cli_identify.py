"""`fpsolve identify` says what `identify` says; its model goes on to webs."""

from dataclasses import replace
from importlib import import_module as module

import numpy as np
import pytest
from command_line import assert_mistake, files
from known_identifications import known_identification
from web_numbers import choose_few_nodes

import fpsolve as fp
from fpsolve.cli.identified import read_identification
from fpsolve.cli.measured import Measured, measured_fibre
from fpsolve.studies.identification import example
from fpsolve.studies.identification.synthetic import laid_fibres

MODEL = fp.LayDownModel(fp.QuadraticPotential(5e-3, 4e-3), 30.0, fp.MovingBelt(0.2))


@pytest.fixture(scope="module")
def short():
    """A basic fibre of 120 throwing ranges on a belt of v = 0.1, in metres."""
    potential = fp.QuadraticPotential(1.0, 0.8)
    model = fp.LayDownModel(potential, 1.0, fp.MovingBelt(0.1))
    return 5e-3 * laid_fibres(model, 1, 1201, 0.1, seed=2)[0]


@pytest.fixture
def table(short, tmp_path):
    """The fibre as a table of millimetres."""
    np.savetxt(tmp_path / "fibre.csv", 1e3 * short, "%.6f", ",", header="x,y",
               comments="")  # fmt: skip
    return tmp_path / "fibre.csv"


def test_the_packaged_fibre_is_identified_in_metres(fpsolve, tmp_path):
    result = fpsolve("identify", "--out", "out")
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "out") == [
        "identification-fibres.png", "identification-increments.png",
        "identification.html", "identification.nc",
    ]  # fmt: skip
    found = fp.load(tmp_path / "out" / "identification.nc")
    true = {"sigma1": example.SIGMA1, "sigma2": example.SIGMA2, "noise": example.NOISE,
            "curvature_noise": example.NOISE / example.RELAXATION_LENGTH}  # fmt: skip
    for name, value in found.parameters.items():
        # One fixed fibre: four parameters are within 3 standard errors 99 % of times.
        assert abs(value - true[name]) < 3 * found.standard_errors[name], name
        row = next(line for line in result.stdout.splitlines() if f" {name} " in line)
        low, high = found.interval(0.95)[name]
        assert f"{value:.4g}" in row
        assert f"{low:.4g} to {high:.4g}" in row
    for name, p in found.p_values.items():
        assert f"{name}     {p:.3f}" in result.stdout
    assert found.provenance["command"] == (
        "fpsolve identify --unit m --model smooth --method likelihood --seed 0"
    )
    page = (tmp_path / "out" / "identification.html").read_text("utf-8")
    assert "Identified parameters" in page


def test_both_models_are_compared_in_one_call(fpsolve, table, tmp_path, monkeypatch):
    smooth = fp.SmoothLayDownModel(MODEL.potential, 2e-3, 30.0, MODEL.curve)
    known = {
        "basic": known_identification(MODEL),
        "smooth": known_identification(smooth),
    }
    known["basic"] = replace(known["basic"], log_likelihood=10.0)
    known["smooth"] = replace(known["smooth"], log_likelihood=12.0)

    def compare_models(fibre, *, method, seed):
        return fp.IdentificationComparison(**known)

    place = module("fpsolve.studies.identification.compare_models")
    monkeypatch.setattr(place, "compare_models", compare_models)
    pages = []
    monkeypatch.setattr(
        module("fpsolve.pages.page"),
        "report_text",
        lambda found: str(pages.append(found)),
    )
    result = fpsolve(
        "identify", table, "--belt-speed", 0.1, "--unit", "mm", "--ds", 5e-4,
        "--model", "both", "--out", "out",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "out") == [
        "identification-basic.nc", "identification-comparison.nc",
        "identification-fibres.png", "identification-increments.png",
        "identification.html", "identification.nc",
    ]  # fmt: skip
    # 2·4 - 2·12 against 2·3 - 2·10.
    assert "AIC prefers the smooth model, by 2.00 (weight 0.731)." in result.stdout
    assert "The goodness of fit rejects neither model." in result.stdout
    assert "-16.00" in result.stdout
    assert "-14.00" in result.stdout
    both = fp.load(tmp_path / "out" / "identification-comparison.nc")
    assert "--model both" in both.provenance["command"]
    for name, file in (("smooth", ""), ("basic", "-basic")):
        found = fp.load(tmp_path / "out" / f"identification{file}.nc")
        assert found.parameters == known[name].parameters
        assert both.identifications[name].parameters == known[name].parameters
        assert "--model both" in found.provenance["command"]
    assert [one.aic for one in pages] == [{"basic": -14.0, "smooth": -16.0}]


def test_the_packaged_fibre_is_what_its_command_writes():
    from importlib.resources import files as packaged

    table = packaged("fpsolve") / "examples" / "fibre.csv"
    points = np.loadtxt(str(table), delimiter=",", skiprows=4)
    again = example.example_points()
    assert points.shape == again.shape
    # To the micrometre to which the table is rounded. Other processors round otherwise
    # in the last bits, and in 550 points that grows to a micrometre.
    np.testing.assert_allclose(points[:400], again[:400], rtol=0, atol=1e-6)


def test_millimetres_model_and_method_are_options(
    fpsolve, table, short, tmp_path, monkeypatch
):
    asked = {}

    def identify(fibre, **options):
        asked.update(options, fibre=fibre)
        return known_identification(MODEL)

    place = module("fpsolve.studies.identification.identify")
    monkeypatch.setattr(place, "identify", identify)
    result = fpsolve(
        "identify", table, "--belt-speed", 0.1, "--unit", "mm", "--ds", 5e-4,
        "--position-error", 1e-8, "--model", "basic", "--method", "functional",
        "--seed", 3, "--no-figures", "--out", "out",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "out") == ["identification.html", "identification.nc"]
    fibre = asked.pop("fibre")
    assert asked == {"model": "basic", "method": "functional", "seed": 3}
    # To the nanometre of the table.
    np.testing.assert_allclose(fibre.eta, short, rtol=0, atol=1e-9)
    assert (fibre.ds, fibre.position_error) == (5e-4, 1e-8)
    assert fibre.curve == fp.MovingBelt(0.1)


@pytest.mark.parametrize("across", [False, True])
def test_a_fibre_that_drifts_from_its_curve_is_told_how_its_points_move(
    short, tmp_path, across
):
    eta = short[:, ::-1] if across else short * [-1, 1]
    np.savetxt(tmp_path / "turned.csv", eta, "%.12f", ",", header="x,y", comments="")
    given = Measured(tmp_path / "turned.csv", 0.1, 5e-4, "m", None, None, None, None,
                     None)  # fmt: skip
    # 600 mm of fibre are 60 mm of belt, with ends that lie 5 mm anywhere.
    along = (
        r"move by -0\.00\d+ m along and -0\.1\d* m|move by -0\.00\d+ m along and -0\.09"
    )
    said = along if across else r"move by (0\.09|0\.1)\d* m along"
    with pytest.raises(ValueError, match=said):
        measured_fibre(given)


def test_pixels_are_metres_and_their_rounding_is_the_error_of_points(short, tmp_path):
    size = 2e-5
    np.savetxt(tmp_path / "pixels.csv", np.round(short / size), "%d", ",")
    given = Measured(tmp_path / "pixels.csv", 0.1, 5e-4, "m", None, None, None, None,
                     None, size)  # fmt: skip
    fibre = measured_fibre(given)
    # A number that is cut at a pixel is uniform in it.
    assert fibre.position_error == pytest.approx(size / 12**0.5, rel=1e-12)
    np.testing.assert_allclose(fibre.eta, short, rtol=0, atol=size / 2 * (1 + 1e-9))
    assert measured_fibre(given._replace(position_error=3e-5)).position_error == 3e-5


@pytest.fixture
def nothing_is_computed(monkeypatch):
    """Mistakes are told before; what gets as far as that fails."""
    monkeypatch.setattr(module("fpsolve.cli.identify"), "print_identification",
                        lambda found: 1 / 0)  # fmt: skip


OF_FIBRE = ("--belt-speed", 0.1, "--unit", "mm", "--ds", 5e-4)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--ds", 5e-4), "`--belt-speed` must be given with a fibre"),
        (("--belt-speed", 0.1, "--unit", "mm"), "`ds` must be given"),
        (("--belt-speed", 0.1, "--ds", 5e-4), "or the unit of the points"),
        (("--belt-speed", 0.1, "--ds", 0.5), "`--unit` and `--belt-speed` must be"),
        ((*OF_FIBRE, "--unit", "inch"), "`--unit` must be one of"),
        ((*OF_FIBRE, "--pixel", 1e-5), "`--unit` must not be given beside `--pixel`"),
        (("--belt-speed", 0.1, "--ds", 5e-4, "--pixel", 0), "`--pixel` must be posit"),
        ((*OF_FIBRE, "--belt-speed", 0.3), "got 0.3, with which it drifts"),
        ((*OF_FIBRE, "--belt-speed", 3), "strictly between -1 and 1"),
        ((*OF_FIBRE, "--ds", "nan"), "`ds` must be positive"),
        ((*OF_FIBRE, "--ds", 1e-2), "in another unit"),
        ((*OF_FIBRE, "--position-error", -1), "`position_error` must be non-negative"),
        ((*OF_FIBRE, "--model", "rough"), "`model` must be one of"),
        ((*OF_FIBRE, "--method", "eye"), "`method` must be one of"),
        ((*OF_FIBRE, "--radius", 0.1), "must not be given without `--nozzle`"),
        ((*OF_FIBRE, "--nozzle", "square"), "`--nozzle` must be one of"),
        ((*OF_FIBRE, "--nozzle", "rotating"), "`--angular-speed` must be given"),
        (
            (*OF_FIBRE, "--nozzle", "rotating", "--angular-speed", 9, "--phase", 1),
            "must not be given without `--radius`",
        ),
        (
            (*OF_FIBRE, "--nozzle", "rotating", "--angular-speed", 9),
            "at least 8 periods",
        ),
    ],
)
def test_a_mistake_is_told_and_leaves_no_file(
    fpsolve, table, tmp_path, words, message, nothing_is_computed
):
    assert_mistake(fpsolve("identify", table, *words, "--out", "out"), message)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "it holds no row of numbers"),
        (b"a,b\n1,2\n2,3\n", "its columns must be eta1, eta2 or x, y"),
        (b"x,y\n1,2\n2\n", "row 2 is no 2 numbers"),
        (b"x,y\n1,2\n2,up\n", "row 2 is no 2 numbers"),
        (b"x,y\n" + b"1,2\nnan,3\n" * 9, "row 2 must be finite, and is ['nan', '3']"),
        (b"x;y\n" + b"".join(b"%d,5;0\n" % n for n in range(50)), "by 2 m along"),
        (b"x,y\n1,2\n", "five|5"),
        (b"\x89HDF\xff\xfe", "it is not text in UTF-8"),
        (b"x,y\n" + b"".join(b"%.2f,0\n" % (0.4 * n) for n in range(50)), "by 0.8 m"),
    ],
)
def test_a_table_that_is_none_is_told(
    fpsolve, tmp_path, text, message, nothing_is_computed
):
    (tmp_path / "bad.csv").write_bytes(text)
    result = fpsolve("identify", "bad.csv", *OF_FIBRE, "--out", "out")
    assert result.exit_code == 2, result.output
    assert any(one in result.stderr for one in message.split("|")), result.stderr
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_rotating_nozzle_is_given_or_fitted(tmp_path):
    """A radius of σ1 and ω = 0.75/σ1 are 5 mm and 150 per metre."""
    model = fp.LayDownModel(
        fp.QuadraticPotential(1.0, 0.8), 1.0, fp.RotatingNozzle(0.05, 1.0, 0.75)
    )
    eta = 5e-3 * laid_fibres(model, 1, 801, 0.1, seed=3)[0]
    s = 5e-4 * np.arange(801)
    np.savetxt(tmp_path / "nozzle.csv", np.column_stack([s, eta]), "%.12f", ",",
               header="s,x,y", comments="")  # fmt: skip
    given = Measured(tmp_path / "nozzle.csv", 0.05, None, "m", None, "rotating",
                     150.0, None, None)  # fmt: skip
    fitted = measured_fibre(given)
    assert fitted.ds == pytest.approx(5e-4, rel=1e-9)
    assert fitted.curve == fp.fit_curve(fitted.with_curve(None), 150.0, 0.05).curve
    known = measured_fibre(given._replace(radius=5e-3, phase=0.4)).curve
    assert known == fp.RotatingNozzle(0.05, 5e-3, 150.0, 0.4)


@pytest.fixture
def identification(tmp_path):
    """A saved one of a basic fibre, of known parameters."""
    return known_identification(MODEL).save(tmp_path / "found.nc")


def test_a_web_is_laid_of_an_identification(fpsolve, identification, tmp_path):
    result = fpsolve(
        "web", "--from", identification, "--width", 0.03, "--length", 0.02, "--seed", 3,
        "--zone", 0.01, "--no-figures", "--out", "out",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    laid = fp.load(tmp_path / "out" / "web.nc")
    model = fp.load(identification).model
    # Spacing and pixel are a tenth of the larger throwing range, 5 mm.
    expected = fp.lay_web(
        model, width=0.03, length=0.02, pixel=5e-4, spacing=5e-4, seed=3
    )
    np.testing.assert_array_equal(laid.length_density, expected.length_density)


def test_of_a_comparison_the_preferred_model_is_taken(tmp_path):
    smooth = fp.SmoothLayDownModel(MODEL.potential, 2e-3, 30.0, MODEL.curve)
    both = [known_identification(one) for one in (MODEL, smooth)]
    told = [
        replace(one, log_likelihood=x) for one, x in zip(both, (9.0, 9.9), strict=True)
    ]
    compared = fp.IdentificationComparison(*told, provenance={"versions": {}})
    path = compared.save(tmp_path / "both.nc")
    # The smooth model has a parameter more, which costs more than 0.9.
    assert read_identification(path, None, []).model == MODEL


def test_errors_of_parameters_are_carried_to_a_prediction(
    fpsolve, identification, tmp_path, monkeypatch
):
    choose_few_nodes(monkeypatch)
    result = fpsolve(
        "predict", "--from", identification, "--zone", 2e-3, "--spacing", 5e-3,
        "--tolerance", 0.5, "--no-figures", "--out", "out",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    predicted = fp.load(tmp_path / "out" / "web-prediction.nc")
    carried = fp.load(identification).cv_errors(predicted)
    np.testing.assert_array_equal(predicted.carried_errors, carried)
    assert f"± {100 * carried[0]:.2g} %" in result.stdout
    assert "of the parameters" in result.stdout
    assert "0.002 m" in result.stdout
    assert predicted.spacing == 5e-3


def test_a_curve_that_was_saved_is_identified_with_its_own_reference(
    fpsolve, tmp_path, monkeypatch
):
    seen = []

    def identify(fibre, *, model, method, seed):
        seen.append(fibre)
        return known_identification(MODEL)

    place = module("fpsolve.studies.identification.identify")
    monkeypatch.setattr(place, "identify", identify)
    angle = 0.1 * np.arange(9)
    eta = 0.05 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    curve = fp.FibreCurve(eta, 0.005, fp.MovingBelt(0.1), position_error=1e-5)
    path = curve.save(tmp_path / "curve.nc")
    words = ("identify", path, "--model", "basic", "--no-figures", "--out", "out")
    assert fpsolve(*words).exit_code == 0
    assert fp.compare(seen[0], curve).equal
    said = "`--belt-speed` must not be given beside a saved curve, got 0.2"
    assert_mistake(fpsolve(*words, "--belt-speed", 0.2), said)
    bare = fp.FibreCurve(eta, 0.005).save(tmp_path / "bare.nc")
    assert_mistake(fpsolve("identify", bare), "saved with its reference curve, got")
