"""Webs for other programs: tables, images with a pixel size, polylines."""

import base64
import json
from xml.etree import ElementTree

import numpy as np
import pytest
import tifffile

import fpsolve as fp
from fpsolve.web.polylines import parts_inside

PROCESS = fp.Process(5e-3, 5e-3, 15.0, 0.2, 20.0)
WEB = fp.lay_web(
    PROCESS, width=0.02, length=0.01, spacing=1e-3, pixel=5e-4, titer=1e-4, seed=2
)
PLAIN = fp.lay_web(
    PROCESS.model, width=4.0, length=2.0, spacing=0.25, pixel=0.25, seed=2
)


def test_a_table_gives_every_pixel_back_bit_for_bit(tmp_path):
    path = WEB.to_csv(tmp_path / "web.csv")
    table = np.genfromtxt(path, delimiter=",", names=True)
    names = ("length_density", "mass_density", "orientation_11", "orientation_12")
    assert table.dtype.names == ("cross", "machine", *names)
    for name in names:
        np.testing.assert_array_equal(table[name], getattr(WEB, name).ravel())
    np.testing.assert_array_equal(table["cross"][:: WEB.machine.size], WEB.cross)


def test_an_image_has_the_mass_in_16_bits_and_the_size_of_its_pixels(tmp_path):
    with tifffile.TiffFile(WEB.to_tiff(tmp_path / "web.tif")) as file:
        page = file.pages[0]
        image, about = page.asarray(), json.loads(page.description)
        along, unit = page.tags["XResolution"].value, page.tags["ResolutionUnit"].value
    assert image.dtype == np.uint16
    assert image.max() == 65535
    # Half of a unit is what rounding takes.
    np.testing.assert_allclose(
        image * about["unit_of_one"], WEB.mass_density, rtol=0,
        atol=0.500001 * about["unit_of_one"],
    )  # fmt: skip
    # Pixels per centimetre: 20 of half a millimetre.
    assert unit == 3
    assert along[0] / along[1] == pytest.approx(20.0, rel=1e-6)


def test_an_image_without_units_says_so(tmp_path):
    with tifffile.TiffFile(PLAIN.to_tiff(tmp_path / "web.tif")) as file:
        page = file.pages[0]
        assert page.tags["ResolutionUnit"].value == 1
        assert json.loads(page.description)["quantity"] == "length per area"


def arrays_of(path):
    """Every array of a file of polylines, by name."""
    found = {}
    for array in ElementTree.parse(path).iter("DataArray"):
        raw = base64.b64decode(array.text)
        size = int(np.frombuffer(raw, "<u8", 1)[0])
        assert size == len(raw) - 8
        kind = {"Float64": "<f8", "Int64": "<i8"}[array.get("type")]
        found[array.get("Name")] = np.frombuffer(raw, kind, offset=8)
    return found


def test_polylines_are_the_fibres_where_they_cross_the_window(tmp_path):
    path = WEB.to_vtp(tmp_path / "web.vtp", fibres=[24, 26], diameter=1.1e-5)
    found = arrays_of(path)
    points, ends = found["Points"].reshape(-1, 3), found["offsets"]
    assert set(found["fibre"]) == {24, 26}
    np.testing.assert_array_equal(found["diameter"], 1.1e-5)
    assert ends[-1] == len(points) == found["connectivity"].size
    expected = [
        part
        for fibre in (24, 26)
        for part in parts_inside(WEB.curve(fibre), WEB.length, WEB.width)
    ]
    np.testing.assert_array_equal(points[:, :2], np.concatenate(expected))
    np.testing.assert_array_equal(points[:, 2], 0.0)
    assert len(expected) == ends.size == found["fibre"].size


def test_a_fibre_that_leaves_and_comes_back_is_two_polylines():
    curve = np.array([[0.5, 0.5], [1.5, 0.5], [2.5, 0.5], [1.5, 0.5], [0.5, 0.5]])
    parts = parts_inside(curve, 1.0, 1.0)
    assert [part.tolist() for part in parts] == [
        curve[:2].tolist(),
        curve[3:].tolist(),
    ]
    assert parts_inside(curve + 5.0, 1.0, 1.0) == []


def test_without_the_library_an_image_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "tifffile", None)
    with pytest.raises(ImportError, match=r"pip install 'fpsolve\[web\]'"):
        WEB.to_tiff(tmp_path / "web.tif")


def test_a_diameter_must_be_positive(tmp_path):
    with pytest.raises(ValueError, match="`diameter` must be positive"):
        WEB.to_vtp(tmp_path / "web.vtp", fibres=[1], diameter=0.0)
    with pytest.raises(ValueError, match="`fibre` must be at most"):
        WEB.curve(10**6)
