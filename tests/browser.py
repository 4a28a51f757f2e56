"""Pages in a browser: the system's Chromium, driven by selenium."""

import shutil
import time
from importlib.util import find_spec

import pytest

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
DRIVER = shutil.which("chromedriver")
NEEDED = pytest.mark.skipif(
    not (BROWSER and DRIVER and find_spec("selenium")),
    reason="needs chromium, chromedriver and selenium",
)
PATIENCE = 60.0  # [s]
NASTY = "<!--<script> $$\\frac{a}{b}$$"


class Page:
    """A page that is open in the browser."""

    def __init__(self, driver, path):
        self.driver = driver
        driver.get(path.as_uri())
        self.wait("document.documentElement.dataset.ready === 'yes'")

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def wait(self, condition):
        end = time.monotonic() + PATIENCE
        while not self.run(f"return {condition}"):
            assert time.monotonic() < end, condition
            time.sleep(0.05)

    def set(self, name, value, event="input"):
        self.run(
            "const field = document.getElementById(arguments[0]); field.value = arguments[1];"
            "field.dispatchEvent(new Event(arguments[2]))",
            name,
            value,
            event,
        )

    def find(self, name):
        return self.driver.find_element("id", name)

    def text(self, name):
        return self.run("return document.getElementById(arguments[0]).textContent", name)

    def click_at(self, chart, x, y):
        """Click on a place of a picture that is given in its data's coordinates."""
        from selenium.webdriver import ActionChains

        where = self.run(
            f"const {{ frame }} = {chart}.view;"
            "return [frame.x_scale.compute(arguments[0]), frame.y_scale.compute(arguments[1])]",
            x,
            y,
        )
        holder = self.run(f"return {chart}.holder")
        self.run("arguments[0].scrollIntoView({ block: 'center' })", holder)
        move = ActionChains(self.driver)
        size = self.run(
            "const b = arguments[0].getBoundingClientRect(); return [b.width, b.height]", holder
        )
        move.move_to_element_with_offset(
            holder, round(where[0] - size[0] / 2), round(where[1] - size[1] / 2)
        )
        move.click().perform()


def look(driver, width=1600, dark=False):
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False},
    )
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})


@pytest.fixture(scope="module")
def driver():
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.ChromeService(executable_path=DRIVER)
    browser = webdriver.Chrome(options=options, service=service)
    yield browser
    browser.quit()


@pytest.fixture
def silent(driver):
    """A browser that says nothing during a test."""
    driver.get_log("browser")
    look(driver)
    yield driver
    assert driver.get_log("browser") == []
