"""The page of a run-down of a million samples in a browser: python -m benchmarks.browser

The size of the page of a recording in closed form, as the tests have it, and how long the browser
takes to the first picture and to each zoom. Needs selenium, chromium and chromedriver.
"""

import contextlib
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from selenium import webdriver

from rotor_fmu.report.run_page import write_report
from tests.recordings import recorded

REPETITIONS, ZOOMS = 5, ("in", "in", "in", "in", "in", "in", "all")
PATIENCE = 60.0  # [s]
# From a click to the second frame after the signal was drawn anew [ms].
ZOOM = """
const [id, done] = arguments;
const before = time.sources[0].data;
const begun = performance.now();
document.getElementById(id).click();
const look = () => {
  if (time.sources[0].data === before) requestAnimationFrame(look);
  else requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now() - begun)));
};
look();
"""
FIRST = "return performance.getEntriesByName('first picture')[0].startTime"


@contextlib.contextmanager
def browser() -> Iterator[webdriver.Chrome]:
    """Headless Chromium, without a network."""
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or shutil.which("chromium-browser") or ""
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1600,1000"):
        options.add_argument(argument)
    service = webdriver.ChromeService(executable_path=shutil.which("chromedriver"))
    driver = webdriver.Chrome(options=options, service=service)
    try:
        yield driver
    finally:
        driver.quit()


def opened(driver: webdriver.Chrome, page: Path) -> float:
    """Open a page; returns the time to its first picture [ms]."""
    driver.get(page.as_uri())
    end = time.monotonic() + PATIENCE
    while not driver.execute_script("return document.documentElement.dataset.ready === 'yes'"):
        if time.monotonic() > end:
            raise TimeoutError(f"{page} is not drawn within {PATIENCE:g} s")
        time.sleep(0.02)
    return driver.execute_script(FIRST)


def main() -> None:
    """Print what was measured."""
    with tempfile.TemporaryDirectory() as name:
        page = Path(name) / "report.html"
        recording = recorded(stop=10.0, step=1e-5)
        write_report(recording, {}, page)
        samples, size = len(recording.t), page.stat().st_size
        first, zooms = [], []
        with browser() as driver:
            for _ in range(REPETITIONS):
                first.append(opened(driver, page))
                zooms += [driver.execute_async_script(ZOOM, button) for button in ZOOMS]
    print(f"| a run-down of {samples} samples | is |\n| --- | --- |")
    print(f"| file | {size / 1e6:.1f} MB |")
    for what, result in (("first picture", first), ("zoom", zooms)):
        print(f"| {what} | {min(result) / 1e3:.2f} to {max(result) / 1e3:.2f} s |")


if __name__ == "__main__":
    main()
