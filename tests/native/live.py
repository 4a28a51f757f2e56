"""A page on which a machine runs, open in a browser."""

from ..documents.browser import Page

# a run-down of half a second
SHORT = "#course.to=395&course.rate=10&bearing%5B1%5D.mu=0.04"


class LivePage(Page):
    """A page at settings that its address holds."""

    def __init__(self, driver, path, settings=SHORT):
        driver.open("about:blank")  # an address that differs in its settings alone opens nothing
        self.address = path.as_uri() + settings
        super().__init__(driver, self)

    def as_uri(self):
        return self.address

    def ended(self, runs=1):
        self.wait(f"Number(document.documentElement.dataset.runs) >= {runs}")
        return self

    def notices(self):
        return self.run(
            "return [...document.querySelectorAll('.notice')].map((n) => n.textContent)"
        )
