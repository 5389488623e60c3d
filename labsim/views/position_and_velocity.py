"""Pictures of chapter 03: positions from directions, fitted motions and their errors, broken assumptions."""

import numpy as np

from labsim.metrics import angle_rmse, rmse
from labsim.views import style
from labsim.views.style import two_digits

SCATTER, TRUTH = (
    {"color": style.BLUE, "alpha": 0.6},
    {"color": style.BLACK, "linestyle": "-", "linewidth": 1.2},
)


class ScatterView:
    """A map of the positions of one run, and the error of position against slant range.

    Draws a dict with `snr_db`; `truth`, `points` (n, 2), m, of one run; `slant_range` (n,), m;
    `error` (n, 2), m, radial and tangential RMSE over runs; and `theory` (n, 2), m.
    """

    def __init__(self):
        self.figure = style.figure(9.5, 4.2)
        axes, curve = self.figure.subplots(1, 2, width_ratios=(3, 2))
        self.points, self.truth = _map(axes, "Near, the points keep to the track; far, they scatter")
        self.error = [curve.plot([], [], m, color=c, ms=3, alpha=0.5)[0] for c, m in _PARTS]
        self.theory = [curve.plot([], [], ls, color=style.BLACK, lw=1.4)[0] for ls in ("--", ":")]
        labels = (
            "along the line of sight",
            "across it",
            r"theory, $r^2\sigma_\perp/z_0$",
            r"theory, $r\,\sigma_\perp$",
        )
        curve.set(xscale="log", yscale="log", xlim=(20, 1000), ylim=(0.03, 3000))
        curve.set(xlabel="slant range r (m)", ylabel="RMSE of position (m)")
        curve.set_xticks([20, 50, 100, 200, 500, 1000], ["20", "50", "100", "200", "500", "1000"])
        curve.set_xticks([], minor=True)
        _legend(self.figure, axes, [*self.error, *self.theory], labels)
        curve.set_title("Error grows as a power of range")
        style.animate(self.points, self.truth, *self.error, *self.theory)

    def draw(self, result):
        """Show the positions and their errors; return the sentence."""
        self.points.set_data(*result["points"].T)
        self.truth.set_data(*result["truth"].T)
        for column, (dots, line) in enumerate(zip(self.error, self.theory, strict=True)):
            dots.set_data(result["slant_range"], result["error"][:, column])
            order = np.argsort(result["slant_range"])
            line.set_data(result["slant_range"][order], result["theory"][order, column])
        ends = np.argmin(result["slant_range"]), np.argmax(result["slant_range"])
        near, far = (_position_error(result["slant_range"][end], *result["error"][end]) for end in ends)
        return f"With {result['snr_db']:.0f} dB at the closest approach, {near}; {far}."


class FitView:
    """Figures 5 and 6 of the paper for one way to fit: the track, the velocity of one run, its error.

    Draws a dict with `fit`, a name; `abeam`, time of closest approach, s; `time` (n,), s; `truth`, `points`,
    `fitted` (n, 2), m, of one run; `velocity` (n, 2), m/s, along and across the true course, of that run;
    `speed`, true, m/s; `error` (n, 2), m/s, RMSE along and across over runs; `runs`; `bound` (n,), m/s;
    and `ahead`, whether the fit also uses windows that come later.
    """

    def __init__(self):
        self.figure = style.figure(9.5, 5.0)
        grid = self.figure.add_gridspec(2, 2, width_ratios=(6, 5))
        axes = self.figure.add_subplot(grid[:, 0])
        velocity = self.figure.add_subplot(grid[0, 1])
        error = self.figure.add_subplot(grid[1, 1], sharex=velocity)
        self.points, self.truth = _map(axes, "", ylim=(-320, 560))
        (self.fitted,) = axes.plot([], [], "s", color=style.ORANGE, ms=3, label="after fitting")
        (self.speed,) = velocity.plot([], [], **TRUTH)
        self.velocity = [velocity.plot([], [], ls, color=c, lw=1.4)[0] for c, ls in _ALONG_ACROSS]
        velocity.set_yscale("symlog", linthresh=20, linscale=2)
        velocity.set(ylabel="velocity, one run (m/s)", ylim=(-400, 400), xlim=(0, 60))
        velocity.set_yticks([-200, -20, -10, 0, 10, 20, 200], ["−200", "−20", "−10", "0", "10", "20", "200"])
        self.error = [error.plot([], [], ls, color=c)[0] for c, ls in _ALONG_ACROSS]
        (self.bound,) = error.plot([], [], color=style.BLACK, linestyle=":")
        error.set(yscale="log", ylim=(0.01, 300), xlabel="time (s)", ylabel="velocity RMSE (m/s)")
        _legend(
            self.figure, axes, [*self.velocity, self.bound], ["along track", "across track", "bound, both"]
        )
        self.titles = [panel.set_title("") for panel in (axes, velocity, error)]
        moving = (self.points, self.truth, self.fitted, self.speed, self.bound)
        style.animate(*moving, *self.velocity, *self.error, *self.titles)

    def draw(self, result):
        """Show one fit; return the sentence."""
        time = result["time"]
        self.points.set_data(*result["points"].T)
        self.truth.set_data(*result["truth"].T)
        self.fitted.set_data(*result["fitted"].T)
        self.speed.set_data([0, 60, np.nan, 0, 60], [result["speed"]] * 2 + [np.nan, 0, 0])
        self.bound.set_data(time, result["bound"])
        for column in (0, 1):
            self.velocity[column].set_data(time, result["velocity"][:, column])
            self.error[column].set_data(time, result["error"][:, column])
        near = np.abs(time - result["abeam"]) < 2
        along, across = np.sqrt(np.nanmean(result["error"][near] ** 2, axis=0))
        self.titles[0].set_text(result["fit"])
        self.titles[1].set_text(f"Near abeam wrong by {two_digits(np.hypot(along, across))} m/s")
        self.titles[2].set_text(_larger("Most of the error lies", along, across))
        return (
            f"{result['fit']}: within 2 s of the closest approach the velocity is wrong by "
            f"{two_digits(along)} m/s along the track and {two_digits(across)} m/s across it "
            f"(RMSE of {result['runs']} runs); the least that all windows so far allow is "
            f"{two_digits(np.nanmean(result['bound'][near]))} m/s"
            f"{' (this fit also looks ahead)' if result['ahead'] else ''}.{_lost(time, result['points'])}"
        )


class ComparisonView:
    """Velocity error against time for several fits, and the bound.

    Made for the four names of `errors`; draws a dict with `time` (n,), s; `errors`, {name: (n,), m/s};
    `bound` (n,), m/s; `abeam`, s; `snr_db`.
    """

    def __init__(self, names):
        self.figure = style.figure(9.5, 4.4)
        axes = self.figure.subplots()
        self.abeam = axes.axvline(0, color=style.GREY, linewidth=1)
        (self.bound,) = axes.plot([], [], color=style.GREY, linewidth=6, alpha=0.35, linestyle="-")
        looks = [*style.LINES[:3], style.LINES[4]]
        self.lines = [
            axes.plot([], [], color=c, ls=ls)[0] for _, (c, ls, _) in zip(names, looks, strict=True)
        ]
        axes.set(yscale="log", xlim=(0, 60), ylim=(0.003, 300))
        axes.set(xlabel="time (s)", ylabel="RMSE of the velocity vector (m/s)")
        axes.set_title("Fit a motion, not a line; and in the end the weights decide")
        labels = [*names, "bound (all windows so far)", "closest approach"]
        axes.legend(
            [*self.lines, self.bound, self.abeam], labels, loc="center left", bbox_to_anchor=(1.0, 0.5)
        )
        style.animate(self.abeam, self.bound, *self.lines)

    def draw(self, result):
        """Show all errors; return the sentence."""
        time, errors = result["time"], result["errors"]
        self.abeam.set_xdata([result["abeam"]] * 2)
        self.bound.set_data(time, result["bound"])
        for line, error in zip(self.lines, errors.values(), strict=True):
            line.set_data(time, error)
        end = np.flatnonzero(np.isfinite(result["bound"]))[-1]
        known = {name: error[end] for name, error in errors.items() if np.isfinite(error[end])}
        said = "; ".join(f"{name}: {two_digits(error)}" for name, error in known.items())
        silent = "; ".join(name for name in errors if name not in known)
        return (
            f"At {result['snr_db']:.0f} dB, after {time[end]:.0f} s, the velocity is wrong by (m/s) {said}; "
            f"the bound is {two_digits(result['bound'][end])}"
            f"{f' (no value at {time[end]:.0f} s: {silent})' if silent else ''}."
        )


class AssumptionView:
    """A track and what one run makes of it, with speed and course against time.

    Made for the limits of the map, (xlim, ylim), m, and the record, s. Draws a dict with `time` (n,), s;
    `truth`, `points`, `fitted` (n, 2), m; `true_velocity`, `velocity` (n, 2), m/s.
    """

    def __init__(self, xlim=(-420, 620), ylim=(-320, 420), duration=60.0):
        self.figure = style.figure(9.5, 4.6)
        grid = self.figure.add_gridspec(2, 2, width_ratios=(6, 5))
        axes = self.figure.add_subplot(grid[:, 0])
        speed = self.figure.add_subplot(grid[0, 1])
        course = self.figure.add_subplot(grid[1, 1], sharex=speed)
        self.points, self.truth = _map(axes, "", xlim=xlim, ylim=ylim)
        (self.fitted,) = axes.plot([], [], "--", color=style.ORANGE, label="after fitting")
        self.true = [panel.plot([], [], **TRUTH)[0] for panel in (speed, course)]
        self.found = [panel.plot([], [], "--", color=style.ORANGE)[0] for panel in (speed, course)]
        speed.set(ylabel="speed (m/s)", ylim=(0, 20), xlim=(0, duration))
        course.set(ylabel="course from x (°)", ylim=(-120, 120), xlabel="time (s)", yticks=range(-90, 91, 45))
        _legend(self.figure, axes)
        self.titles = [panel.set_title("") for panel in (axes, speed, course)]
        style.animate(self.points, self.truth, self.fitted, *self.true, *self.found, *self.titles)

    def draw(self, result):
        """Show truth and estimate; return the sentence."""
        self.points.set_data(*result["points"].T)
        self.truth.set_data(*result["truth"].T)
        self.fitted.set_data(*result["fitted"].T)
        true, found = (_speed_and_course(result[name]) for name in ("true_velocity", "velocity"))
        for panel in (0, 1):
            self.true[panel].set_data(result["time"], true[panel])
            self.found[panel].set_data(result["time"], _broken(found[panel]) if panel else found[panel])
        known = np.isfinite(found[0]) & (result["time"] > 10)
        miss = rmse((found[0] - true[0])[known])
        turn = np.degrees(angle_rmse(*np.radians([found[1], true[1]])[:, known]))
        off = rmse(np.linalg.norm(result["fitted"] - result["truth"], axis=-1)[known])
        self.titles[0].set_text(f"Position wrong by {two_digits(off)} m")
        self.titles[1].set_text(f"Speed wrong by {two_digits(miss)} m/s")
        self.titles[2].set_text(f"Course wrong by {two_digits(turn)}°")
        first, last = result["time"][known][[0, -1]]
        return (
            f"From {first:.0f} to {last:.0f} s speed is wrong by {two_digits(miss)} m/s (on average it is "
            f"{np.mean((found[0] / true[0])[known]):.2f} times the truth) and course by {two_digits(turn)}°, "
            f"root mean squares over time in one run."
        )


_PARTS = (style.BLUE, "o"), (style.ORANGE, "s")
_ALONG_ACROSS = (style.BLUE, "-"), (style.ORANGE, "--")


def _map(axes, title, xlim=(-420, 620), ylim=(-320, 420)):
    axes.plot(0, 0, "^", color=style.BLACK, ms=9, label="sensor", linestyle="none")
    (points,) = axes.plot([], [], ".", ms=4, **SCATTER, label="eq. 5, one run")
    (truth,) = axes.plot([], [], **TRUTH, label="truth")
    axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", xlim=xlim, ylim=ylim)
    axes.set_title(title)
    return points, truth


def _legend(figure, axes, more=(), labels=()):
    figure.get_layout_engine().set(h_pad=0.08)
    handles, names = axes.get_legend_handles_labels()
    figure.legend([*handles, *more], [*names, *labels], loc="outside lower center", ncols=8)


def _lost(time, points):
    """A sentence on the windows whose direction does not meet the surface; nothing where all do."""
    lost = np.isnan(points[:, 0])
    return f" Beyond {time[lost][0]:.0f} s some directions no longer meet the surface." if lost.any() else ""


def _broken(course):
    """A course in degrees with a gap wherever it passes from +180 to -180 or back."""
    jump = np.abs(np.diff(course, prepend=course[0])) > 180
    return np.where(jump, np.nan, course)


def _larger(start, along, across):
    ratio = along / across
    if ratio > 2:
        return f"{start} along the track"
    return f"{start} across the track" if ratio < 0.5 else "Errors along and across the track are alike"


def _position_error(distance, along, across):
    if np.isnan(along):
        return f"at {distance:.0f} m slant range some directions no longer meet the surface"
    return (
        f"at {distance:.0f} m slant range a position is wrong by {two_digits(along)} m along the line of "
        f"sight and {two_digits(across)} m across it"
    )


def _speed_and_course(velocity):
    return np.hypot(*velocity.T), np.degrees(np.arctan2(velocity[:, 1], velocity[:, 0]))
