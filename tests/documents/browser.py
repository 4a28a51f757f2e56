"""Pages in the browsers that are installed: Chromium and Firefox."""

import time

import pytest

from .chromium import Chromium
from .firefox import Firefox

PATIENCE = 60.0  # [s]
NASTY = "<!--<script> $$\\frac{a}{b}$$"
# keys, as WebDriver names them
ENTER, LEFT, RIGHT = "\ue007", "\ue012", "\ue014"


class Element:
    """A part of a page."""

    def __init__(self, page, node):
        self.page, self.node = page, node

    def run(self, script):
        return self.page.run(f"const node = arguments[0]; {script}", self.node)

    def click(self):
        box = "const { left, top, width, height } = node.getBoundingClientRect();"
        self.run("node.scrollIntoView({ block: 'center', behavior: 'instant' })")
        x, y = self.run(f"{box} return [left + width / 2, top + height / 2]")
        self.page.mouse(x, y, "click")

    def press(self, *keys):
        self.run("node.focus()")
        self.page.press(*keys)

    def get_property(self, name):
        return self.page.run("return arguments[0][arguments[1]]", self.node, name)

    def is_displayed(self):
        return self.run("return node.checkVisibility({ visibilityProperty: true })")


class Page:
    """A page that is open in a browser; is_anew: loaded also where the browser shows it already."""

    def __init__(self, driver, path, is_anew=True):
        self.driver = driver
        if is_anew or self.run("return location.href") != path.as_uri():
            driver.open(path.as_uri())
        self.wait("document.documentElement.dataset.ready === 'yes'")

    def run(self, script, *arguments):
        return self.driver.run(script, *arguments)

    def wait(self, condition):
        end = time.monotonic() + PATIENCE
        while not self.run(f"return {condition}"):
            assert time.monotonic() < end, condition
            time.sleep(0.02)

    def set(self, name, value, event="input"):
        self.run(
            "const field = document.getElementById(arguments[0]); field.value = arguments[1];"
            "field.dispatchEvent(new Event(arguments[2]))",
            name,
            value,
            event,
        )

    def find(self, name):
        return Element(self, self.run("return document.getElementById(arguments[0])", name))

    def text(self, name):
        return self.run("return document.getElementById(arguments[0]).textContent", name)

    def press(self, *keys):
        """Press keys, one after the other, on what has the focus."""
        self.wait("document.hasFocus()")
        strokes = [{"type": f"key{way}", "value": key} for key in keys for way in ("Down", "Up")]
        self.driver.perform([{"type": "key", "id": "keys", "actions": strokes}])

    def mouse(self, x, y, *acts):
        """Bring the mouse to a place of the window [px] and let it `click` there, go `down` or `up`
        or to another place."""
        actions = [_move((x, y))]
        for act in acts:
            if isinstance(act, str):
                ways = ("down", "up") if act == "click" else (act,)
                actions += [{"type": f"pointer{way.title()}", "button": 0} for way in ways]
            else:
                actions.append(_move(act))
        kind = {"pointerType": "mouse"}
        self.driver.perform(
            [{"type": "pointer", "id": "mouse", "parameters": kind, "actions": actions}]
        )

    def double_click_until(self, condition, x, y):
        """Click twice at a place of the window [px], and again where a loaded machine took both
        clicks too far apart for a double click."""
        end = time.monotonic() + PATIENCE
        while not self.run(f"return {condition}"):
            assert time.monotonic() < end, condition
            self.mouse(x, y, "click", "click")
            again = time.monotonic() + 0.5
            while time.monotonic() < again and not self.run(f"return {condition}"):
                time.sleep(0.05)

    def wheel(self, x, y, turned):
        """Turn the wheel by so many pixels at a place of the window [px]."""
        turn = {
            "type": "scroll",
            "deltaX": 0,
            "deltaY": turned,
            "duration": 0,
            "origin": "viewport",
        }
        turn |= {"x": round(x), "y": round(y)}
        self.driver.perform([{"type": "wheel", "id": "wheel", "actions": [turn]}])

    def place(self, chart, x, y=None):
        """Return where the window [px] shows a place of a picture, given in its data's coordinates;
        without y it is at the picture's middle height."""
        return self.run(
            f"const {{ frame }} = {chart}.view, {{ holder }} = {chart};"
            "holder.scrollIntoView({ block: 'center', behavior: 'instant' });"
            "const { left, top, height } = holder.getBoundingClientRect(), [x, y] = arguments;"
            "return [left + frame.x_scale.compute(x),"
            "top + (y === null ? height / 2 : frame.y_scale.compute(y))]",
            x,
            y,
        )

    def click_at(self, chart, x, y):
        """Click on a place of a picture that is given in its data's coordinates."""
        self.mouse(*self.place(chart, x, y), "click")


def _move(place):
    x, y = (round(each) for each in place)
    return {"type": "pointerMove", "x": x, "y": y, "duration": 0, "origin": "viewport"}


def look(driver, width=1600, dark=False):
    driver.look(width, 1000, dark)


def _installed(browser, *marks):
    lacks = pytest.mark.skipif(bool(browser.lacks), reason=browser.lacks)
    return pytest.param(browser, marks=[lacks, *marks], id=browser.__name__)


# Firefox has its turn with the slow tests
@pytest.fixture(
    scope="session", params=[_installed(Chromium), _installed(Firefox, pytest.mark.slow)]
)
def driver(request):
    browser = request.param()
    yield browser
    browser.quit()


@pytest.fixture
def silent(driver):
    """A browser that says nothing during a test."""
    driver.said()
    look(driver)
    yield driver
    assert driver.said() == []
