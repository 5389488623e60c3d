"""Pictures of chapter 04: the bend of a wave, the ranging-error table, its causes, averages, a beam."""

import numpy as np
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.textpath import TextPath
from matplotlib.transforms import IdentityTransform

from labsim.noise import decibels
from labsim.views import style

AXES = ("along the line (η)", "broadside (ζ)", "up (ξ)")
FULL_SCALE = 40.0


def percent(error):
    """A relative error in words: signed per cent, "infinite" or "behind"."""
    if np.isnan(error):
        return "behind"
    if np.isinf(error):
        return "infinite"
    return f"{round(100 * error, 1) + 0.0:+.1f} %" if abs(error) < 1 else f"{100 * error:+.0f} %"


def _limits(axes, **limits):
    """Set xlim or ylim, but only when it changes: that costs a new background."""
    for name, ends in limits.items():
        if getattr(axes, f"get_{name}")() != ends:
            axes.set(**{name: ends})


class WavefrontView:
    """The wave across the array, to scale and with the bend magnified.

    Draws a dict with `target_range`, m; `bearing`, rad; `spacing`, m; `displacement`, m, of H2 towards the
    target; `along` (n,) and `bend` (n,), m; `outer_bend`, m, at H1 and H3; `estimate`, m.
    """

    def __init__(self):
        self.figure = style.figure(9, 3.9)
        self.plan, self.close = self.figure.subplots(1, 2)
        (self.front,) = self.plan.plot([], [], color=style.BLUE, linestyle="-", label="wave")
        (self.places,) = self.plan.plot([], [], "o", color=style.BLACK, label="hydrophones")
        (self.towards,) = self.plan.plot([], [], color=style.ORANGE, linestyle="--", label="to the target")
        self.plan.set(xlim=(-85, 85), ylim=(-60, 60), aspect="equal")
        self.plan.set(xlabel="along the line (m)", ylabel="broadside (m)")
        self.plan.set_title("To scale, the wave is straight")
        self.plan.legend(loc="lower right")
        (self.wave,) = self.close.plot([], [], color=style.BLUE, linestyle="-", label="the wave's bend")
        (self.read,) = self.close.plot(
            [], [], color=style.ORANGE, linestyle="--", label="bend the array believes in"
        )
        (self.dots,) = self.close.plot([], [], "o", color=style.BLACK, label="where the hydrophones are")
        self.close.set(xlim=(-85, 85), ylim=(-14, 70))
        self.close.set(xlabel="along the line (m)", ylabel="behind the front (cm)")
        self.title = self.close.set_title("")
        self.close.legend(loc="upper center", ncols=1)
        style.animate(self.front, self.places, self.towards, self.wave, self.read, self.dots, self.title)

    def draw(self, result):
        """Draw the wave of a target and where the hydrophones sit on it."""
        bearing, spacing = result["bearing"], result["spacing"]
        towards = np.array([np.sin(bearing), np.cos(bearing)])
        across = np.array([np.cos(bearing), -np.sin(bearing)])
        reach = np.linspace(-80, 80, 81)
        sag = reach**2 / (2 * result["target_range"])
        self.front.set_data(*(np.outer(across, reach) + np.outer(towards, sag)))
        self.places.set_data([-spacing, 0, spacing], [0, 0, 0])
        self.towards.set_data(*np.outer(towards, [0, 50]))
        shift, outer = 100 * result["displacement"], 100 * result["outer_bend"]
        believed = (outer + shift) * (result["along"] / spacing) ** 2 - shift
        self.wave.set_data(result["along"], 100 * result["bend"])
        self.read.set_data(result["along"], believed)
        self.dots.set_data([-spacing, 0, spacing], [outer, -shift, outer])
        _limits(self.close, ylim=(-14, 70) if outer < 60 else (-28, 140))
        error = percent(result["estimate"] / result["target_range"] - 1)
        error = "none can be given, it seems to lie behind" if error == "behind" else error
        self.title.set_text(f"Magnified: {outer:.1f} cm of bend")
        return (
            f"The wave of a target at {result['target_range'] / 1000:.1f} km bends by {outer:.1f} cm over "
            f"an arm of {spacing:.0f} m; with the middle hydrophone {shift:+.1f} cm out of place the range "
            f"error is: {error}."
        )


class Lettering:
    """Many changing numbers drawn as one shape: a step of the table takes 15 ms, with matplotlib's Texts 60.

    axes : laid out already; colour : of the letters; size : their height, points
    """

    LETTERS = "0123456789.-()∞behind"

    def __init__(self, axes, colour, size=10):
        pixels = size * axes.figure.dpi / 72
        self.axes, self.line_height = axes, 1.3 * pixels
        self.glyphs = {letter: TextPath((0, 0), letter, size=pixels) for letter in set(self.LETTERS)}
        zero = TextPath((0, 0), "00", size=pixels).get_extents().x1
        self.advance = {
            letter: TextPath((0, 0), f"0{letter}0", size=pixels).get_extents().x1 - zero
            for letter in self.glyphs
        }
        self.patch = PathPatch(Path([(0, 0)]), facecolor=colour, linewidth=0, transform=IdentityTransform())
        self.patch.set_zorder(5)
        axes.add_artist(self.patch)

    def write(self, lines):
        """Write lines, each ((x, y) in data, number of the line from 0 or 1, text), centred there."""
        if not lines:
            self.patch.set_path(Path([(0, 0)]))
            return
        pieces = []
        for (x, y), number, text in lines:
            left, base = self.axes.transData.transform((x, y))
            left -= sum(self.advance[letter] for letter in text) / 2
            base += self.line_height * (0.1 - number)
            for letter in text:
                pieces.append(Path(self.glyphs[letter].vertices + (left, base), self.glyphs[letter].codes))
                left += self.advance[letter]
        self.patch.set_path(Path.make_compound_path(*pieces))


class ErrorTableView:
    """Table 1, live: the range error for four ranges, three axes and three bearings.

    Draws a dict with `table`, an ErrorTable of one displacement; `ranges`, m; `bearings`, rad;
    `displacement` and `spacing`, m.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 4.1)
        axes = self.axes = self.figure.subplots()
        shape = len(result["ranges"]), 3 * len(result["bearings"])
        self.image = axes.imshow(
            np.zeros(shape), cmap=style.FIELD_MAP, vmin=0, vmax=FULL_SCALE, aspect="auto"
        )
        bearings_deg = np.degrees(result["bearings"])
        axes.set_xticks(range(shape[1]), [f"{bearing:.0f}°" for bearing in bearings_deg] * 3)
        axes.set_yticks(range(shape[0]), [f"{r / 1000:.0f}" for r in result["ranges"]])
        axes.set(xlabel="bearing of the target, and axis of the displacement", ylabel="range (km)")
        axes.grid(False)
        for group, name in enumerate(AXES):
            axes.text(3 * group + 1, -0.62, name, ha="center", va="bottom", fontsize=10)
        edges = [axes.axvline(edge, color="white", linewidth=4) for edge in (2.5, 5.5)]
        axes.set_title("What an ignored displacement costs, in % of the range (to first order)", pad=24)
        bar = self.figure.colorbar(self.image, ax=axes, extend="max", fraction=0.03, pad=0.02)
        bar.set_label("size of the error (%)")
        self.figure.draw_without_rendering()
        self.cells = [(column, row) for row, column in np.ndindex(shape)]
        self.light, self.dark = Lettering(axes, "white"), Lettering(axes, "black")
        style.animate(self.image, *edges, self.light.patch, self.dark.patch)

    def draw(self, result):
        """Fill the table."""
        exact, first = (
            100 * errors[:, 0].reshape(len(result["ranges"]), -1)
            for errors in (result["table"].exact, result["table"].first_order)
        )
        size = np.nan_to_num(np.abs(exact), nan=FULL_SCALE, posinf=FULL_SCALE)
        self.image.set_data(size)
        bright = size.ravel() > 0.55 * FULL_SCALE
        for lettering, chosen in ((self.light, ~bright), (self.dark, bright)):
            lettering.write(
                [
                    (self.cells[k], line, text)
                    for k in np.flatnonzero(chosen)
                    for line, text in enumerate(self.words(exact.flat[k], first.flat[k]))
                ]
            )
        row, column = np.unravel_index(
            np.argmax(np.where(np.isnan(exact), np.inf, np.abs(exact))), exact.shape
        )
        bearing = np.degrees(result["bearings"])[column % 3]
        worst = percent(exact[row, column] / 100)
        return (
            f"With {100 * result['displacement']:+.1f} cm ignored and arms of {result['spacing']:.0f} m, the "
            f"worst cell is {result['ranges'][row] / 1000:.0f} km, {bearing:.0f}°, displaced "
            f"{AXES[column // 3]}: {worst}."
        )

    @staticmethod
    def words(exact, first):
        """The two lines of a cell: the exact error, and that to first order in brackets."""
        if np.isnan(exact):
            return "behind", f"({first + 0.0:.1f})"
        shown = "∞" if np.isinf(exact) else f"{exact:.2f}" if abs(exact) < 10 else f"{exact:.1f}"
        return shown, f"({first + 0.0:.1f})"


class BudgetView:
    """The range error against range, and what each cause alone does at one range.

    Draws a dict with `ranges` (n,), m; `exact`, `first_order`, `jitter` (n,), relative; `target_range`, m;
    `error`, relative; `causes`, a dict from name to relative error, always the same names.
    """

    REACH = (40, 100, 400)

    def __init__(self, result):
        self.figure = style.figure(9, 3.9)
        self.curve, self.bars = self.figure.subplots(1, 2, width_ratios=(3, 2))
        kilometres = result["ranges"] / 1000
        (self.exact,) = self.curve.plot(
            kilometres, 0 * kilometres, color=style.BLUE, linestyle="-", label="exact"
        )
        (self.first,) = self.curve.plot(
            kilometres, 0 * kilometres, color=style.ORANGE, linestyle="--", label="to first order"
        )
        (self.upper,) = self.curve.plot(
            kilometres,
            0 * kilometres,
            color=style.GREEN,
            linestyle=":",
            label="one standard deviation of jitter",
        )
        (self.lower,) = self.curve.plot(kilometres, 0 * kilometres, color=style.GREEN, linestyle=":")
        (self.dot,) = self.curve.plot([], [], "o", color=style.BLACK, markersize=8, label="this target")
        self.curve.set(xlim=(0, kilometres[-1]), ylim=(-40, 40))
        self.curve.set(xlabel="range (km)", ylabel="range error (%)")
        self.curve.set_title("Errors grow with range")
        self.curve.legend(loc="upper left")
        names = list(result["causes"])
        self.patches = self.bars.barh(names, np.zeros(len(names)), color=style.BLUE, height=0.6)
        self.bars.set(xlim=(-40, 40), xlabel="range error from this alone (%)")
        self.bars.axvline(0, color=style.BLACK, linewidth=1)
        self.bars.invert_yaxis()
        self.bars.set_title("One cause at a time")
        style.animate(self.exact, self.first, self.upper, self.lower, self.dot, *self.patches)

    def draw(self, result):
        """Draw the curves and the bars."""
        exact = 100 * np.where(np.isinf(result["exact"]), np.nan, result["exact"])
        self.exact.set_ydata(exact)
        self.first.set_ydata(100 * result["first_order"])
        self.upper.set_ydata(exact + 100 * result["jitter"] * (1 + exact / 100))
        self.lower.set_ydata(exact - 100 * result["jitter"] * (1 + exact / 100))
        self.dot.set_data([result["target_range"] / 1000], [100 * result["error"]])
        size = np.nan_to_num(abs(100 * result["error"]), nan=0, posinf=0)
        reach = next((limit for limit in self.REACH if size < limit), self.REACH[-1])
        _limits(self.curve, ylim=(-reach, reach))
        _limits(self.bars, xlim=(-reach, reach))
        for patch, error in zip(self.patches, result["causes"].values(), strict=True):
            patch.set_width(100 * np.nan_to_num(error, nan=10, posinf=10))
        worst = max(
            result["causes"], key=lambda name: np.nan_to_num(np.abs(result["causes"][name]), nan=np.inf)
        )
        return (
            f"At {result['target_range'] / 1000:.1f} km the range error is {percent(result['error'])}; "
            f"the largest single cause is {worst} ({percent(result['causes'][worst])})."
        )


class AveragingView:
    """Averages of many noisy readings: of range, and of curvature.

    Draws a dict with `of_range`, `of_curvature` (trials,), relative to the true range; `noise`, relative;
    `samples`, in each average; `edges` (bins + 1,), of the histogram.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.6)
        axes = self.axes = self.figure.subplots()
        edges = result["edges"]
        flat = np.zeros(edges.size - 1)
        self.curvature = axes.stairs(flat, edges, color=style.BLUE, linewidth=2, label="1 / (average of 1/R)")
        self.range = axes.stairs(
            flat, edges, color=style.ORANGE, linestyle="--", linewidth=2, label="average of R"
        )
        axes.axvline(1, color=style.BLACK, linewidth=1, label="truth")
        axes.set(xlim=(edges[0], edges[-1]), ylim=(0, 1.08))
        axes.set(xlabel="averaged range / true range", ylabel="how often (peak = 1)")
        axes.legend(loc="upper right")
        self.title = axes.set_title("")
        style.animate(self.curvature, self.range, self.title)

    def draw(self, result):
        """Draw both histograms."""
        for patch, values in ((self.curvature, result["of_curvature"]), (self.range, result["of_range"])):
            counts, _ = np.histogram(values, result["edges"])
            patch.set_data(counts / max(counts.max(), 1))
        bias, right = (round(np.nanmedian(result[n]) - 1, 3) + 0.0 for n in ("of_range", "of_curvature"))
        wild = np.mean(np.abs(result["of_range"] - 1) > 0.5)
        self.title.set_text(
            f"Averaging range reads {100 * bias:+.1f} %, averaging curvature {100 * right:+.1f} %"
        )
        return (
            f"With {100 * result['noise']:.0f} % noise on each curvature and {result['samples']} "
            f"reading{'' if result['samples'] == 1 else 's'} averaged, the "
            f"median average of range is {100 * bias:+.1f} % off and that of curvature {100 * right:+.1f} %; "
            f"{100 * wild:.1f} % of the averages of range miss by more than half."
        )


class VerticalBeamView:
    """What a vertical line hydrophone hears from above and below.

    Draws a dict with `elevation_deg` (n,); `pattern` (n,), power; `arrivals_deg` (3,): direct, surface,
    bottom; `levels` (3,), power; `bearing_pull_deg`; `range_error`, relative; `width_deg`, peak to null.
    """

    NAMES = ("direct", "from the surface", "from the bottom")

    def __init__(self, result):
        self.figure = style.figure(9, 3.6)
        axes = self.axes = self.figure.subplots()
        (self.pattern,) = axes.plot(
            result["elevation_deg"], 0 * result["elevation_deg"], color=style.BLUE, linestyle="-"
        )
        self.arrivals = [
            axes.plot([], [], marker, color=colour, markersize=10, label=name)[0]
            for marker, colour, name in zip(
                "osD", (style.BLACK, style.ORANGE, style.GREEN), self.NAMES, strict=True
            )
        ]
        axes.set(xlim=(-30, 50), ylim=(-40, 2))
        axes.set(xlabel="elevation (°)", ylabel="response (dB)")
        axes.legend(loc="upper right")
        self.title = axes.set_title("")
        style.animate(self.pattern, *self.arrivals, self.title)

    def draw(self, result):
        """Draw the pattern and the arrivals on it."""
        self.pattern.set_ydata(decibels(np.maximum(result["pattern"], 1e-5)))
        levels = decibels(np.maximum(result["levels"], 1e-5))
        for artist, angle, level in zip(self.arrivals, result["arrivals_deg"], levels, strict=True):
            artist.set_data([angle], [max(level, -40)])
        self.title.set_text(f"The first null is {result['width_deg']:.1f}° from the peak")
        return (
            f"The reflections arrive {levels[0] - levels[1]:.0f} dB (surface) and "
            f"{levels[0] - levels[2]:.0f} dB (bottom) below the direct sound; together they pull the bearing "
            f"by {round(float(result['bearing_pull_deg']), 2) + 0.0:+.2f}° "
            f"and the range by {percent(result['range_error'])}."
        )
