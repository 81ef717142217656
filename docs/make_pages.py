"""Makes docs/pictures/: pages of a run, a comparison and a sweep. Needs Playwright and Chromium.

python docs/make_pages.py [--chromium /usr/bin/chromium]
"""

import argparse
import sys
import tempfile
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Browser, sync_playwright

import warpwear
from warpwear import Study

PICTURES = Path(__file__).parent / "pictures"
FLAGS = ["--no-sandbox", "--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader"]
#: Most bytes of a picture, and the colours that it is reduced to for that.
MOST, COLOURS = 200_000, 128
SIZE = {"width": 1120, "height": 900}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--chromium", default="/usr/bin/chromium")
    chromium = parser.parse_args().chromium
    if not Path(warpwear.__file__).is_relative_to(PICTURES.parents[1]):
        sys.exit(f"{warpwear.__file__} is not of this checkout: set PYTHONPATH to the checkout's folder.")
    PICTURES.mkdir(exist_ok=True)
    study = Study.load("v3-fine").replace({"grid.cell": "5 um", "sliding.distance": "30 mm"})
    with tempfile.TemporaryDirectory() as place, sync_playwright() as playwright:
        folder = Path(place)
        for name, load in (("eight newtons", "8 N"), ("four newtons", "4 N")):
            warpwear.run(study.replace({"study.name": name, "contact.load": load}), out=folder / name).close()
        warpwear.compare(folder / "eight newtons", folder / "four newtons").write(folder / "compared")
        vary: dict[str, Any] = {"contact.load": ["2 N", "4 N", "8 N"], "disc.synthetic.seed": "1:5"}
        coarse = study.replace({"grid.cell": "10 um"})
        warpwear.sweep(coarse, vary=vary, band_over="disc.synthetic.seed", out=folder / "swept", workers=2)
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        page, compared = folder / "eight newtons/report.html", folder / "compared/compare.html"
        picture(browser, page, "page")
        picture(browser, page, "page-bodies", at="#bodies-3d", dark=True)
        picture(browser, page, "page-assumed", at="#assumptions")
        picture(browser, compared, "compare")
        picture(browser, folder / "swept/sweep.html", "sweep", at="#courses")
        browser.close()


def picture(browser: Browser, path: Path, name: str, *, at: str = "", dark: bool = False) -> None:
    """Take the picture of a page, from the element `at` on, and keep it small."""
    page = browser.new_page(viewport=SIZE, color_scheme="dark" if dark else "light")  # type: ignore[arg-type]
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-ready]", timeout=90_000)
    if at:
        page.locator(at).evaluate("node => node.scrollIntoView({block: 'start'})")
        page.wait_for_timeout(1000)
    shot = Image.open(BytesIO(page.screenshot())).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    shot.save(PICTURES / f"{name}.png", optimize=True)
    size = (PICTURES / f"{name}.png").stat().st_size
    print(f"{name}.png: {size / 1e3:.0f} kB")
    assert size < MOST, name
    page.close()


if __name__ == "__main__":
    main()
