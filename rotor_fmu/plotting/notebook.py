"""Figures as notebooks show them."""

import io
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def png(figure: "Figure") -> bytes:
    """Return a figure as a PNG."""
    from .figure_style import write_png

    buffer = io.BytesIO()
    write_png(figure, buffer)
    return buffer.getvalue()


def shown(figure: "Figure") -> "Figure":
    """Return the same figure, which a notebook shows although pyplot has no part in it."""
    ipython = sys.modules.get("IPython")
    shell = ipython and ipython.get_ipython()
    if shell is not None:
        formatter = shell.display_formatter.formatters["image/png"]
        if type(figure) not in formatter:
            formatter.for_type(type(figure), png)
    return figure
