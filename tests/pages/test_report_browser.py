"""Reports in a real browser: drawn without complaints, nothing cut off, printable."""

import base64
import io
import os
import shutil

import pytest
from result_files import KINDS, page_file

pytestmark = pytest.mark.documents

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
WIDE, NARROW = 1200, 400
SEVERAL = ("fibres.nc", "rate-quadratic.nc", "spectrum.nc")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-dev-shm-usage",
)  # fmt: skip

if not (CHROMIUM and DRIVER) and not os.environ.get("FPSOLVE_REQUIRE_CHROMIUM"):
    pytest.skip(
        "chromium and chromedriver are not installed; .ci/chromium installs them",
        allow_module_level=True,
    )


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """A headless Chromium with an empty profile, which keeps its console messages."""
    if not (CHROMIUM and DRIVER):
        pytest.fail(
            "FPSOLVE_REQUIRE_CHROMIUM is set, but chromium or chromedriver is missing; "
            ".ci/chromium installs both"
        )
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in FLAGS:
        options.add_argument(flag)
    options.add_argument(f"--user-data-dir={tmp_path_factory.mktemp('profile')}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.ChromeService(DRIVER)
    driver = webdriver.Chrome(options=options, service=service)
    yield driver
    driver.quit()


@pytest.fixture(params=[*((name,) for name in KINDS), SEVERAL], ids="+".join)
def names(request):
    """The results of a page: of every kind one alone, and some together."""
    return request.param


@pytest.fixture
def opened(browser, names):
    """`opened(width)` shows the page in a window of that width."""
    address = page_file(*names).as_uri()

    def show(width, scheme="light"):
        browser.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False},
        )
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
        browser.get(address)
        return browser

    return show


def boxes(browser, selector):
    """Width and height of every element on the page, and whether pictures are drawn."""
    return browser.execute_script(
        "return Array.from(document.querySelectorAll(arguments[0])).map(e => {"
        "  const box = e.getBoundingClientRect();"
        "  return [box.width, box.height, e.complete, e.naturalWidth];"
        "});",
        selector,
    )


def overflow(browser):
    """CSS pixels by which the page is wider than the window."""
    return browser.execute_script(
        "return document.documentElement.scrollWidth - window.innerWidth;"
    )


def test_pages_are_drawn_without_a_word_on_the_console(opened):
    browser = opened(WIDE)
    assert browser.title
    assert browser.execute_script("return document.compatMode;") == "CSS1Compat"
    assert browser.get_log("browser") == []


def test_figures_and_equations_are_visible(opened):
    browser = opened(WIDE)
    pictures = boxes(browser, "img")
    assert pictures
    for width, height, complete, natural in pictures:
        assert complete
        assert natural > 0
        # Half a column of the page is 400 pixels wide.
        assert width > 300
        assert height > 100
    formulas = boxes(browser, "math")
    assert formulas
    for width, height, *_ in formulas:
        # A line of text is 20 pixels high, B(ξ) = ‖ξ‖ four times as wide.
        assert width > 60
        assert height > 12


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_nothing_sticks_out_of_the_window(opened, width):
    browser = opened(width)
    assert overflow(browser) <= 0
    for picture, *_ in boxes(browser, "img"):
        assert picture <= width


def test_a_dark_scheme_has_light_text_on_a_dark_ground(opened):
    colours = []
    for scheme in ("light", "dark"):
        browser = opened(WIDE, scheme)
        colours.append(
            browser.execute_script(
                "const style = getComputedStyle(document.body);"
                "return [style.color, style.backgroundColor].map("
                "  colour => colour.match(/\\d+/g).slice(0, 3).map(Number));"
            )
        )
    (text, ground), (dark_text, dark_ground) = colours
    # 8-bit brightness; readable text needs a contrast of more than half the range.
    assert sum(ground) - sum(text) > 3 * 150
    assert sum(dark_text) - sum(dark_ground) > 3 * 150


def test_pages_print_with_text_figures_and_what_is_folded(opened, names):
    from pypdf import PdfReader

    browser = opened(WIDE)
    printed = browser.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})
    pdf = PdfReader(io.BytesIO(base64.b64decode(printed["data"])))
    text = "\n".join(page.extract_text() for page in pdf.pages)
    assert len(pdf.pages) >= 1
    assert "Provenance" in text
    assert "Written by fpsolve" in text
    # A4 in points, to the point.
    width, height = pdf.pages[0].mediabox.width, pdf.pages[0].mediabox.height
    assert (round(float(width)), round(float(height))) == (595, 842)
    if "laydown.nc" in names:
        assert "spinning_speed = 50.0" in text


def test_no_table_or_formula_is_cut_off_in_print(opened):
    browser = opened(WIDE)
    # The width of the text on A4 with margins of 16 mm: 178 mm at 96 pixels an inch.
    text_width = round(178 / 25.4 * 96)
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": text_width, "height": 900, "deviceScaleFactor": 1, "mobile": False},
    )
    try:
        for selector in ("table", "math", "img", "pre"):
            for width, *_ in boxes(browser, selector):
                assert width <= text_width
    finally:
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
