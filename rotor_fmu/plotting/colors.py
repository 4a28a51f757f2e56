"""The colours and dashes of lines, and the colours of words, in all pictures."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

BLUE, ORANGE, GREEN, GREY = "#0072b2", "#d55e00", "#009e73", "#999999"  # Okabe and Ito
LABEL = "#555555"  # of words in a picture
PURPLE, SKY, BLACK = "#cc79a7", "#56b4e9", "#000000"
COLORS = (BLUE, ORANGE, GREEN, PURPLE, "#e69f00", SKY, BLACK, GREY)
_SCALE = "viridis"  # of the colours of more lines than these
DASHED, DOTTED, LIMIT = (0, (4, 2)), (0, (1, 1.5)), (0, (4, 3))  # of lines


def colors_of(count: int) -> Sequence[str]:
    """Return the colours of so many lines, each another one."""
    if count <= len(COLORS):
        return COLORS[:count]
    return [to_hex(color) for color in colormaps[_SCALE](np.linspace(0, 1, count))]
