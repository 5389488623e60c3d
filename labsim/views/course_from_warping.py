"""The pictures of chapter 06: modes, stripes, warped pulses, and the course that they give."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from labsim.metrics import angle_difference
from labsim.views import style

NAMES = {
    "paper": "the paper's estimator",
    "centred": "centred",
    "correlated": "correlated errors",
    "free": "bearings only, free",
    "anchored": "bearings only, anchored",
}
STYLES = dict(zip(NAMES, (style.LINES[k] for k in (0, 2, 4, 1, 3)), strict=True))


class ModesView:
    """Mode shapes, level against range, and level against frequency.

    Draws a dict with `depth` (z,), `shapes` (n, z) at `frequency` Hz, `water_depth`; `distance` (r,) m and
    `level_db` (r,); `band` (f,) Hz and `spectrum_db` (f,) at `here`, m; `beat` m, of modes 1 and 2, or None.
    """

    SHOWN = 12
    DEEPEST = 120
    LEVELS = (-115, -35)

    def __init__(self):
        self.figure = style.figure(9, 4.6)
        grid = self.figure.add_gridspec(2, 2, width_ratios=(2, 3))
        self.sea = self.figure.add_subplot(grid[:, 0])
        self.ahead, self.across = self.figure.add_subplot(grid[0, 1]), self.figure.add_subplot(grid[1, 1])
        self.lines = [self.sea.plot([], [], "-", color=style.BLUE)[0] for _ in range(self.SHOWN)]
        (self.bottom,) = self.sea.plot([], [], "--", color=style.ORANGE, label="sea bed")
        self.sea.set(xlabel="mode number", ylabel="depth (m)", xlim=(0.4, 12.8), ylim=(self.DEEPEST, 0))
        self.sea.set_xticks(range(1, 13))
        self.sea.legend(loc="lower right")
        self.title = self.sea.set_title("Modes")
        (self.level,) = self.ahead.plot([], [], "-", color=style.BLUE, linewidth=1.2)
        (self.place,) = self.ahead.plot([], [], ":", color=style.BLACK)
        self.ahead.set(xlabel="range (km)", ylabel="level (dB re 1 m)", xlim=(1, 15), ylim=self.LEVELS)
        self.ahead.set_title("At one frequency the level swings with range")
        (self.spectrum,) = self.across.plot([], [], "-", color=style.GREEN, linewidth=1.2)
        (self.tone,) = self.across.plot([], [], ":", color=style.BLACK)
        self.across.set(xlabel="frequency (Hz)", ylabel="level (dB re 1 m)", xlim=(20, 500), ylim=self.LEVELS)
        self.across.set_title("At one range it swings with frequency")
        moving = (self.level, self.place, self.spectrum, self.tone, self.bottom, self.title)
        style.animate(*self.lines, *moving)

    def draw(self, result):
        """Draw one sea; return the sentence."""
        shapes = result["shapes"]
        count = len(shapes)
        for number, line in enumerate(self.lines):
            shown = number < count
            shape = shapes[number] / np.max(np.abs(shapes)) * 0.45 if shown else []
            line.set_data(number + 1 + shape if shown else [], result["depth"] if shown else [])
        self.bottom.set_data([0.4, 12.8], [result["water_depth"]] * 2)
        self.level.set_data(result["distance"] / 1e3, np.maximum(result["level_db"], self.LEVELS[0]))
        self.place.set_data([result["here"] / 1e3] * 2, self.LEVELS)
        self.spectrum.set_data(result["band"], np.maximum(result["spectrum_db"], self.LEVELS[0]))
        self.tone.set_data([result["frequency"]] * 2, self.LEVELS)
        modes = f"{count} mode{'s' if count > 1 else ''}"
        first = f" (the first {self.SHOWN} are drawn)" if count > self.SHOWN else ""
        self.title.set_text(f"{modes} at {result['frequency']:.0f} Hz")
        beat = (
            f"modes 1 and 2 beat every {result['beat']:.0f} m" if result["beat"] else "alone it cannot beat"
        )
        return f"At {result['frequency']:.0f} Hz this sea traps {modes}{first}; {beat}."


class StripesView:
    """A spectrogram of a passing vessel with lines f = f_0 M^beta over it.

    Draws a dict with `time` (k,) s, `frequency` (f,) Hz, `level_db` (k, f), `lines` (n, k) Hz, `beta`,
    `contrast`.
    """

    COLOURS = ScalarMappable(Normalize(-15, 9), style.FIELD_MAP)

    def __init__(self):
        self.figure = style.figure(8.4, 4.0)
        self.axes = self.figure.subplots()
        self.image = self.axes.imshow(
            self.COLOURS.to_rgba(np.zeros((2, 2)), bytes=True), origin="lower", aspect="auto",
            interpolation="nearest", extent=(100, 500, 0, 20),
        )  # fmt: skip
        (self.lines,) = self.axes.plot([], [], "--", color="white", linewidth=1.4)
        self.axes.set(xlabel="frequency (Hz)", ylabel="time (min)", xlim=(100, 500), ylim=(0, 20))
        self.axes.grid(False)
        self.figure.colorbar(self.COLOURS, ax=self.axes, label="level (dB re mean)", pad=0.01)
        self.title = self.axes.set_title("Stripes")
        style.animate(self.image, self.lines, self.title)

    def draw(self, result):
        """Draw the spectrogram and the lines; return the sentence."""
        time = np.append(result["time"] / 60, np.nan)
        lines = np.pad(result["lines"], ((0, 0), (0, 1)), constant_values=np.nan)
        self.image.set_data(self.COLOURS.to_rgba(result["level_db"], bytes=True))
        self.lines.set_data(lines.ravel(), np.tile(time, len(lines)))
        kept = 100 * result["contrast"]
        self.title.set_text(f"beta {result['beta']:.2f} keeps {kept:.0f} % of the contrast")
        return (
            f"Read along lines of beta = {result['beta']:.2f}, the stripes keep "
            f"{kept:.0f} % of their contrast."
        )


class WarpView:
    """A power spectrum, its warped form, and the pulses at the start and now.

    Draws a dict with `frequency` (f,), `spectrum` (f,); `warped_frequency` (n,), `warped` (n,); `delay` (d,)
    s, `first` and `now` (d,); `marks` (p, 2) expected delays (first, now), s; `first_delay`, `now_delay` s of
    the followed pulse; `minute`, `beta`, `ratio`, `true_ratio`, `pair`.
    """

    PAIRS = ("2-3", "3-4", "2-4", "1-4")

    def __init__(self):
        self.figure = style.figure(9, 4.6)
        grid = self.figure.add_gridspec(2, 2, height_ratios=(2, 3))
        self.before, self.after = self.figure.add_subplot(grid[0, 0]), self.figure.add_subplot(grid[0, 1])
        self.pulses = self.figure.add_subplot(grid[1, :])
        (self.raw,) = self.before.plot([], [], "-", color=style.BLUE, linewidth=1.2)
        self.before.set(xlabel="frequency (Hz)", ylabel="power / mean", xlim=(199, 401), ylim=(0, 6.5))
        self.before.set_title("The spectrum chirps ...")
        (self.straight,) = self.after.plot([], [], "-", color=style.GREEN, linewidth=1.2)
        self.after.set(xlabel="warped frequency (Hz)", ylabel="power / mean", xlim=(200, 400), ylim=(0, 6.5))
        self.after.set_title("... warped, it is a sum of tones")
        (self.first,) = self.pulses.plot([], [], "--", color=style.GREY, linewidth=1.4, label="at the start")
        (self.now,) = self.pulses.plot([], [], "-", color=style.BLUE, label="now")
        (self.marks,) = self.pulses.plot([], [], ":", color=style.BLACK, label="expected now")
        (self.peaks,) = self.pulses.plot([], [], "o", color=style.ORANGE, label="the followed pulse")
        self.labels = [self.pulses.text(0, 1.04, pair, ha="center", fontsize=9) for pair in self.PAIRS]
        self.pulses.set(xlabel="delay (ms)", ylabel="pulse height / highest", xlim=(15, 205), ylim=(0, 1.15))
        self.figure.legend(loc="outside lower center", ncols=4)
        self.title = self.pulses.set_title("Pulses")
        moving = (self.raw, self.straight, self.first, self.now, self.marks, self.peaks, self.title)
        style.animate(*moving, *self.labels)

    def draw(self, result):
        """Draw one moment; return the sentence."""
        self.raw.set_data(result["frequency"], result["spectrum"] / np.mean(result["spectrum"]))
        warped = np.maximum(result["warped"] / np.mean(result["warped"]), 0)
        self.straight.set_data(result["warped_frequency"], warped)
        first, now = result["first"] / result["first"].max(), result["now"] / result["now"].max()
        delay = 1e3 * result["delay"]
        self.first.set_data(delay, first)
        self.now.set_data(delay, now)
        marks = 1e3 * np.array(result["marks"])[:, 1]
        self.marks.set_data(np.repeat(marks, 3), np.tile([0, 1.03, np.nan], marks.size))
        for label, mark in zip(self.labels, marks, strict=True):
            label.set_x(mark)
        followed = 1e3 * np.array([result["first_delay"], result["now_delay"]])
        self.peaks.set_data(
            followed, [np.interp(followed[0], delay, first), np.interp(followed[1], delay, now)]
        )
        pair, ratio, true = result["pair"], result["ratio"], result["true_ratio"]
        self.title.set_text(f"Pulse {pair}: ratio of delays {ratio:.3f}, of ranges {true:.3f}")
        return (
            f"With beta = {result['beta']:.2f} assumed, pulse {pair} stands at {followed[1]:.0f} ms after "
            f"{result['minute']:.1f} min; its ratio {ratio:.3f} is {100 * abs(ratio / true - 1):.1f} % from "
            "that of the ranges."
        )


class PassagesView:
    """Dong et al. 2020, figures 3, 5 and 6: where the vessels sail, and how fast.

    Draws a dict with `time` (k,) s and, for each of the two in `vessels`, (`position` (k, 2) m, `speed` (k,)
    m/s).
    """

    VESSELS = {"uniform": ("-", style.BLUE, 4.5, 0.55), "accelerating": ("--", style.ORANGE, 1.8, 1.0)}

    def __init__(self):
        self.figure = style.figure(9, 3.9)
        self.map, self.curve = self.figure.subplots(1, 2, width_ratios=(3, 2))
        self.map.plot(0, 0, "^", color=style.BLACK, markersize=10, label="array")
        self.paths, self.ends, self.sights, self.speeds = {}, {}, {}, {}
        for name, (line, colour, width, alpha) in self.VESSELS.items():
            look = {"color": colour, "linestyle": line, "linewidth": width, "alpha": alpha, "label": name}
            (self.paths[name],) = self.map.plot([], [], **look)
            (self.ends[name],) = self.map.plot([], [], "o", color=colour)
            (self.sights[name],) = self.map.plot([], [], color=colour, linestyle=":", linewidth=1)
            (self.speeds[name],) = self.curve.plot([], [], **look)
        (self.first,) = self.map.plot([], [], color=style.GREY, linestyle=":", linewidth=1)
        self.map.set(xlabel="x (km)", ylabel="y (km)", xlim=(-6, 7), ylim=(-0.8, 10.5), aspect="equal")
        self.map.set_title("Figures 3 and 5: the same course ...")
        self.map.legend(loc="lower left")
        self.curve.set(xlabel="time (min)", ylabel="speed (m/s)", xlim=(0, 20), ylim=(0, 12))
        self.curve.set_title("Figure 6: ... at two speeds")
        self.curve.legend(loc="upper left")

    def draw(self, result):
        """Draw both vessels; return the sentence."""
        parts = []
        for name, (position, speed) in result["vessels"].items():
            x, y = position.T / 1e3
            self.paths[name].set_data(x, y)
            self.ends[name].set_data(x[-1:], y[-1:])
            self.sights[name].set_data([0, x[-1]], [0, y[-1]])
            self.speeds[name].set_data(result["time"] / 60, speed)
            first, last = np.degrees(np.arctan2(y[[0, -1]], x[[0, -1]]))
            parts.append(f"the {name} one from {first:.0f}° to {last:.0f}°")
        self.first.set_data([0, x[0]], [0, y[0]])
        return f"Seen from the array two vessels sail, {' and '.join(parts)}."


class SceneView:
    """Dong et al. 2020, figures 4 and 7: bearing record, warped delays, range ratio, and course against time.

    look_deg : (beams,), delay : (d,), s, of the two fields; names : of the figure, by motion, for its titles.
    Draws a dict with `time` (k,) s; `record_db` (b, beams); `envelope` (k, d), `track` (k,) s; `ratio`,
    `true_ratio`, `ratio_error`; `courses_deg` by estimator (k,), `true_course_deg`; `pair`; `motion`.
    """

    COURSES = (140, 280)

    def __init__(self, look_deg, delay, names=None):
        self.figure = style.figure(9.2, 6.2)
        (self.beams, self.warped), (self.ratios, self.courses) = self.figure.subplots(2, 2)
        (self.follow,) = self.warped.plot([], [], "--", color="white", linewidth=1.6)
        self.record = self._field(self.beams, "bearing (°)", look_deg, (-2, -1, 0))
        self.field = self._field(self.warped, "delay (ms)", 1e3 * delay, (-14, -7, 0))
        self.warped.set_xlim(15, 175)
        (self.true,) = self.ratios.plot([], [], "--", color=style.ORANGE, label="true")
        (self.measured,) = self.ratios.plot([], [], "-", color=style.BLUE, label="measured", linewidth=1.2)
        self.ratios.set(xlabel="time (min)", ylabel="range ratio", xlim=(0, 20), ylim=(0.8, 1.05))
        self.ratios.legend(loc="upper center")
        band = {"color": style.GREY, "alpha": 0.25, "label": "true ± 5°"}
        self.courses.fill_between([0, 20], 175, 185, **band)
        self.lines = {}
        for key in ("paper", "centred", "free", "anchored"):
            colour, line, _ = STYLES[key]
            (self.lines[key],) = self.courses.plot([], [], color=colour, linestyle=line, label=NAMES[key])
        self.courses.set(xlabel="time (min)", ylabel="course (°)", xlim=(0, 20), ylim=self.COURSES)
        self.courses.legend(loc="upper right", fontsize=8)
        self.names, fixed = names or {}, (self.beams.set_title(" "), self.warped.set_title(" "))
        self.titles = [*fixed, self.ratios.set_title(" "), self.courses.set_title(" ")]
        moving = (self.follow, self.true, self.measured, *self.lines.values(), *self.titles[2:])
        style.animate(self.record, self.field, *moving)

    def _field(self, axes, label, across, ticks):
        image = axes.imshow(
            np.zeros((2, 2)), origin="lower", aspect="auto", vmin=ticks[0], vmax=ticks[-1],
            interpolation="nearest", extent=(across[0], across[-1], 0, 20),
        )  # fmt: skip
        axes.set(xlabel=label, ylabel="time (min)", ylim=(0, 20))
        axes.grid(False)
        self.figure.colorbar(image, ax=axes, label="level (dB re peak)", pad=0.01, ticks=ticks)
        return image

    def draw(self, result):
        """Draw one scene; return the sentence."""
        time = result["time"] / 60
        self.record.set_data(result["record_db"])
        level = result["envelope"][::2] / result["envelope"][::2].max(axis=1, keepdims=True)
        self.field.set_data(20 * np.log10(np.maximum(level[:, ::2], 0.05)))
        self.follow.set_data(1e3 * result["track"], time)
        self.true.set_data(time, result["true_ratio"])
        self.measured.set_data(time, result["ratio"])
        final = {}
        for name, line in self.lines.items():
            course = result["courses_deg"][name] % 360
            inside = (course > self.COURSES[0]) & (course < self.COURSES[1])
            line.set_data(time, np.where(inside, course, np.nan))
            ends = np.radians([course[-1], result["true_course_deg"]])
            final[name] = _signed(np.degrees(angle_difference(*ends)))
        off = f"{100 * result['ratio_error']:.1f} %"
        titles = (
            "the bearing turns",
            "pulses move with range",
            f"range ratio {off} off",
            f"paper's {final['paper']}, anchored {final['anchored']}",
        )
        for artist, letter, text in zip(self.titles, "abcd", titles, strict=True):
            artist.set_text(f"{self.names.get(result['motion'], '')}{letter}: {text}")
        return (
            f"The {result['motion']} vessel: range ratio from pulse {result['pair']} {off} off on average; "
            f"course errors at 20 min: the paper's estimator {final['paper']}, centred {final['centred']}, "
            f"bearings only {final['free']} (free) and {final['anchored']} (anchored)."
        )


class ErrorsView:
    """RMSE of the course against time for the estimators, with the Cramer-Rao bound.

    Draws a dict with `time` (k,) s, `rmse_deg` by estimator (k,), `bound_deg` (k,), `trials`.
    """

    RANGE = (0.01, 200)

    def __init__(self):
        self.figure = style.figure(9, 4.8)
        self.axes = self.figure.subplots()
        self.lines = {}
        for name, (colour, line, _) in STYLES.items():
            (self.lines[name],) = self.axes.plot([], [], color=colour, linestyle=line, label=NAMES[name])
        (self.bound,) = self.axes.plot([], [], "-", color=style.GREY, linewidth=4, alpha=0.5, label="bound")
        self.axes.set(xlabel="time (min)", ylabel="RMSE of the course (°)", xlim=(0, 20), ylim=self.RANGE)
        self.axes.set_yscale("log")
        ticks = (0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100)
        self.axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        self.figure.legend(loc="outside lower center", ncols=3)
        self.title = self.axes.set_title("Errors")
        style.animate(*self.lines.values(), self.bound, self.title)

    def draw(self, result):
        """Draw the curves; return the sentence."""
        time = result["time"][::4] / 60
        for name, line in self.lines.items():
            line.set_data(time, result["rmse_deg"][name][::4])
        bound = result["bound_deg"][::4]
        self.bound.set_data(time, np.where(bound < self.RANGE[1], bound, np.nan))
        ends = {name: curve[-1] for name, curve in result["rmse_deg"].items()}
        ends["bound"] = result["bound_deg"][-1]
        times = ends["paper"] / ends["bound"]
        self.title.set_text(f"The paper's estimator ends at {times:.1f} times the bound")
        told = {name: _degrees(value) for name, value in ends.items()}
        return (
            f"RMSE at 20 min over {result['trials']} trials: the paper's estimator {told['paper']}, centred "
            f"{told['centred']}, correlated errors {told['correlated']}, bearings only {told['free']} (free) "
            f"and {told['anchored']} (anchored); bound for any speed {told['bound']}."
        )


class SweepView:
    """Dong et al. 2020, figures 8-13: RMSE at 20 minutes and mean bearing rate against one property.

    Draws a dict that has for each of `SWEEPS` (values (n,), rmse_deg by estimator (n,), rate (n,) deg/min).
    """

    SWEEPS = {
        "course (°)": ("Fig. 8: across beats along", "Fig. 9: some courses turn faster"),
        "first range (km)": ("Fig. 10: nearer is easier", "Fig. 11: far vessels turn slowly"),
        "speed (m/s)": ("Fig. 12: faster is easier", "Fig. 13: fast vessels turn fast"),
    }

    def __init__(self):
        self.figure = style.figure(9.4, 5.8)
        self.rows, self.lines = self.figure.subplots(2, 3, sharex="col"), {}
        for (top, low), (label, titles) in zip(self.rows.T, self.SWEEPS.items(), strict=True):
            for name, (colour, line, marker) in STYLES.items():
                (self.lines[label, name],) = top.semilogy(
                    [], [], color=colour, linestyle=line, marker=marker, markersize=3.5, label=NAMES[name]
                )
            top.set(title=titles[0], ylim=(0.01, 300))
            top.set_yticks([0.01, 0.1, 1, 10, 100], ["0.01", "0.1", "1", "10", "100"])
            (self.lines[label, "rate"],) = low.plot([], [], "-", color=style.BLACK, marker="o", markersize=3)
            low.set(title=titles[1], xlabel=label)
        self.rows[0, 0].set_ylabel("RMSE at 20 min (°)")
        self.rows[1, 0].set_ylabel("mean bearing rate (°/min)")
        handles, names = self.rows[0, 0].get_legend_handles_labels()
        self.figure.legend(handles, names, loc="outside lower center", ncols=5)

    def draw(self, result):
        """Draw all six panels; return the sentence."""
        for low, (label, (values, rmse, rate)) in zip(self.rows[1], result.items(), strict=True):
            for name, curve in (*rmse.items(), ("rate", rate)):
                self.lines[label, name].set_data(values, curve)
            margin = 0.05 * np.ptp(values)
            low.set(xlim=(min(values) - margin, max(values) + margin), ylim=(0, 1.05 * max(rate)))
        (values, rmse, _), *others = result.values()
        best = np.sort(values[np.argsort(rmse["paper"])[:2]])
        ends = [
            f"from {_degrees(curves['paper'][0])} to {_degrees(curves['paper'][-1])}"
            for _, curves, _ in others
        ]
        return (
            f"Over course the paper's estimator is best at {best[0]:.0f}° and {best[1]:.0f}°; its error goes "
            f"{ends[0]} as the first range grows and {ends[1]} as the speed does."
        )


class FirstBearingView:
    """Each trial's course error against the error of its first bearing.

    Draws a dict with `first_deg` (n,), `paper_deg` and `centred_deg` (n,) errors, `slope` predicted,
    `course_deg`, `share` of the paper's variance that is due to the first bearing.
    """

    def __init__(self):
        self.figure = style.figure(9, 4.2)
        self.panels = self.figure.subplots(1, 2, sharex=True, sharey=True)
        self.points = []
        for axes, name, text in zip(
            self.panels, ("paper", "centred"), (" ", "Centred: no such line"), strict=True
        ):
            colour, _, marker = STYLES[name]
            (points,) = axes.plot([], [], marker, color=colour, markersize=4, linestyle="none", alpha=0.6)
            self.points.append(points)
            axes.set(xlabel="error of the first bearing (°)", xlim=(-1.7, 1.7), ylim=(-4.2, 4.2))
            axes.set_title(text)
        self.panels[0].set_ylabel("error of the course at 20 min (°)")
        (self.line,) = self.panels[0].plot([], [], "--", color=style.ORANGE, label="predicted")
        self.panels[0].legend(loc="upper left")
        self.title = self.panels[0].set_title("The paper's estimator")
        style.animate(*self.points, self.line, self.title)

    def draw(self, result):
        """Draw all trials; return the sentence."""
        for points, name in zip(self.points, ("paper_deg", "centred_deg"), strict=True):
            points.set_data(result["first_deg"], result[name])
        edge = np.array([-1.7, 1.7])
        self.line.set_data(edge, result["slope"] * edge)
        spread = {name: np.sqrt(np.mean(result[f"{name}_deg"] ** 2)) for name in ("paper", "centred")}
        share = 100 * result["share"]
        self.title.set_text(f"The paper's: {share:.0f} % of the variance is one bearing")
        return (
            f"Course {result['course_deg']:.0f}°: the first bearing brings {share:.0f} % of the variance of "
            f"the paper's estimator; RMSE {spread['paper']:.2f}° against {spread['centred']:.2f}° centred."
        )


class RecordedView:
    """A recorded track, the points that bearing and range ratio draw, and the course over a sliding window.

    track : (n, 2), m, the recorded positions; last : s, their end. Draws a dict with `time` (k,) s,
    `points` (m, 2) m, `course_deg` and `true_course_deg` (k,), `off_deg` the median error, `window` frames.
    """

    def __init__(self, track, last):
        self.figure = style.figure(9, 4.2)
        self.map, self.curve = self.figure.subplots(1, 2)
        self.map.plot(*track.T / 1e3, "--", color=style.ORANGE, label="recorded track")
        (self.points,) = self.map.plot([], [], ".", color=style.BLUE, markersize=4, label="bearing and ratio")
        low, high = track.min(axis=0) / 1e3 - 0.15, track.max(axis=0) / 1e3 + 0.15
        self.map.set(xlabel="x (km)", ylabel="y (km)", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        self.map.set_aspect("equal")
        self.map.legend(loc="lower right")
        self.map.set_title("Bearing and range ratio draw the track")
        (self.true,) = self.curve.plot([], [], "--", color=style.ORANGE, label="recorded track")
        (self.course,) = self.curve.plot([], [], "-", color=style.BLUE, label="estimate")
        self.curve.set(xlabel="middle of the window (s)", ylabel="course (°)", ylim=(-90, 270))
        self.curve.set(xlim=(0, last), yticks=range(-90, 271, 45))
        self.curve.legend(loc="upper left")
        self.title = self.curve.set_title("Course")
        style.animate(self.points, self.true, self.course, self.title)

    def draw(self, result):
        """Draw the points and the courses; return the sentence."""
        self.points.set_data(*result["points"].T / 1e3)
        self.true.set_data(result["time"], (result["true_course_deg"] + 90) % 360 - 90)
        self.course.set_data(result["time"], (result["course_deg"] + 90) % 360 - 90)
        self.title.set_text(f"A window of {result['window']} frames is {result['off_deg']:.0f}° off (median)")
        return (
            f"Windows of {result['window']} frames give the course of the recorded track to "
            f"{result['off_deg']:.0f}° (median)."
        )


def _degrees(value):
    return f"{value:.{0 if value >= 10 else 1 if value >= 1 else 2 if value >= 0.1 else 3}f}°"


def _signed(value):
    return f"{value:+.1f}°".replace("-", "\N{MINUS SIGN}")
