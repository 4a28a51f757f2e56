"""The system's Chromium, driven by selenium."""

import shutil
from importlib.util import find_spec

PROGRAM = shutil.which("chromium") or shutil.which("chromium-browser")
DRIVER = shutil.which("chromedriver")


class Chromium:
    """The Chromium that is installed, without a window."""

    lacks = (
        ""
        if PROGRAM and DRIVER and find_spec("selenium")
        else "needs chromium, chromedriver and selenium"
    )

    def __init__(self):
        from selenium import webdriver

        options = webdriver.ChromeOptions()
        options.binary_location = PROGRAM
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        service = webdriver.ChromeService(executable_path=DRIVER)
        self.driver = webdriver.Chrome(options=options, service=service)
        self.open = self.driver.get
        self.run = self.driver.execute_script
        self.printed = self.driver.print_page
        self.quit = self.driver.quit

    def perform(self, sources):
        self.driver.execute("actions", {"actions": sources})

    def look(self, width, height, dark):
        screen = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})

    def said(self):
        """Return what the console had to say since it was asked last."""
        return self.driver.get_log("browser")
