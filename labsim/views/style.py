"""One look for every figure: sizes, fonts, and colours that stay apart in greyscale."""

from pathlib import Path

import matplotlib.style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

BLUE, ORANGE, GREEN, PINK, BLACK = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000"
GREY = "#767676"
LINES = (
    (BLUE, "-", "o"),
    (ORANGE, "--", "s"),
    (GREEN, "-.", "^"),
    (PINK, ":", "D"),
    (BLACK, (0, (5, 1, 1, 1, 1, 1)), "v"),
)
FIELD_MAP = "cividis"


def figure(width=9.0, height=4.2):
    """An empty figure of width x height inches in the lab's style, for a view to fill."""
    matplotlib.style.use(Path(__file__).with_name("labsim.mplstyle"))
    result = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(result)
    return result


def animate(*artists):
    """Mark the artists that a slider moves; all others are drawn once. Returns them."""
    for artist in artists:
        artist.set_animated(True)
    return artists


def two_digits(value):
    """A number in two significant digits, without powers of ten."""
    return f"{float(f'{value:.2g}'):g}"
