"""Pictures of chapter 05: the discriminator, its loops, fades, false sources, and the operator's desk."""

import numpy as np
from matplotlib import colormaps

from labsim.views import style

US = 1e6
PAPER_TICKS = (np.inf, 20.0, 5.0, 3.0, 2.0, 1.5, 1.0)
DESK_TICKS = (np.inf, 10.0, 5.0, 3.0, 2.5, 2.0, 1.75, 1.5, 1.25, 1.125, 1.0)


def _one_line(x, y):
    """The coordinates of many lines y (lines, n) over x as those of one line with gaps: quicker to draw."""
    gap = np.full((len(y), 1), np.nan)
    return tuple(np.hstack([np.broadcast_to(each, y.shape), gap]).ravel() for each in (x, y))


class DiscriminatorView:
    """The discriminator's curve: theory, its tangent, and what a record of some seconds gives.

    Draws a dict with `error` (n,), s; `measured`, `exact`, `tangent` (n,), per unit of power, s;
    `now`, s, and `push`, the exact curve there; `peak` and `cliff`, s; `seconds`.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.9)
        axes = self.figure.subplots()
        x = US * result["error"]
        (self.measured,) = axes.plot(x, 0 * x, color=style.GREEN, linestyle="-.", label="measured")
        axes.plot(x, US * result["exact"], color=style.BLUE, linestyle="-", label="theory")
        axes.plot(
            x, US * result["tangent"], color=style.ORANGE, linestyle="--", label="tangent, 4 x (eq. 3.3)"
        )
        (self.dot,) = axes.plot([], [], "o", color=style.BLACK, markersize=9, label="your delay error")
        for name, at in (("peak", result["peak"]), ("cliff", result["cliff"])):
            for side in (-1, 1):
                axes.axvline(side * US * at, color=style.GREY, linewidth=1, linestyle=":")
            axes.text(US * at + 8, -640, f"{name}\n{US * at:.0f} µs", color=style.BLACK, fontsize=9)
        axes.set(xlim=(x[0], x[-1]), ylim=(-700, 900))
        axes.set(xlabel="delay error x = x₁ - x₀ (µs)", ylabel="discriminator / signal power (µs)")
        axes.legend(loc="upper center", ncols=4)
        self.title = axes.set_title("")
        style.animate(self.measured, self.dot, self.title)

    def draw(self, result):
        """Draw the measured curve and the reader's place on the exact one."""
        now, push = result["now"], result["push"]
        self.measured.set_ydata(US * result["measured"])
        self.dot.set_data([US * now], [US * push])
        if abs(now) < result["peak"]:
            says = "pushes back, the harder the larger the error"
        elif abs(now) < result["cliff"]:
            says = "still pushes back, but weaker the larger the error"
        else:
            says = "pushes the wrong way, towards the next period"
        self.title.set_text(f"At {US * now:+.0f} µs the discriminator {says}")
        scatter = np.std(result["measured"] - result["exact"])
        return (
            f"At a delay error of {US * now:+.0f} µs the discriminator reads {US * push:+.0f} µs and {says}; "
            f"after {result['seconds']:.1f} s of listening its curve scatters by {US * scatter:.0f} µs."
        )


class ResponseView:
    """A loop answering a jump or a ramp of the delay.

    Draws a dict with `time` (n,), s; `truth`, `theory`, `mean` (n,), s; `trials` (n, m), s;
    `time_constant`, s; `left`, the mean error at the end, s; `jitter`, s; `slipped`, the share of loops
    that ended nearer to another period.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.7)
        axes = self.figure.subplots()
        time = result["time"]
        self.trials = [
            axes.plot(
                time,
                0 * time,
                color=style.GREY,
                linestyle="-",
                linewidth=0.9,
                label="_" if k else "single loops",
            )[0]
            for k in range(result["trials"].shape[1])
        ]
        (self.truth,) = axes.plot(time, 0 * time, color=style.BLACK, linestyle=":", label="true delay")
        (self.mean,) = axes.plot(time, 0 * time, color=style.BLUE, linestyle="-", label="mean of many loops")
        (self.theory,) = axes.plot(time, 0 * time, color=style.ORANGE, linestyle="--", label="theory")
        axes.set(xlim=(0, time[-1]), ylim=(-60, 345), xlabel="time (s)", ylabel="delay (µs)")
        axes.legend(loc="upper left", ncols=2)
        self.title = axes.set_title("")
        style.animate(*self.trials, self.truth, self.mean, self.theory, self.title)

    def draw(self, result):
        """Draw the delay and the loops behind it."""
        for line, trial in zip(self.trials, result["trials"].T, strict=True):
            line.set_ydata(US * trial)
        for line, name in ((self.truth, "truth"), (self.mean, "mean"), (self.theory, "theory")):
            line.set_ydata(US * result[name])
        lowest = min(US * np.min(result["trials"]), US * np.min(result["mean"]))
        limits = (-60, 345) if lowest > -60 else (-420, 420)
        if self.mean.axes.get_ylim() != limits:
            self.mean.axes.set_ylim(limits)
        left, jitter = round(US * result["left"]), round(US * result["jitter"])
        self.title.set_text(f"At the end the loop is {left} µs behind and jitters by {jitter} µs")
        return (
            f"With a time constant of {result['time_constant']:.2f} s the loop ends {left} µs behind the "
            f"true delay on average, and single loops scatter by {jitter} µs{_slipped(result['slipped'])}."
        )


class TuningView:
    """One knob, two errors: lag and jitter against the time constant.

    Draws a dict with `constants` (n,), s; `lags`, `jitters`, `totals` (n,), s, theory; `revealed`;
    `time_constant`, `best`, s; `lag`, `jitter3`, `total`, s, measured; `least`, s, theory; `slipped`, the
    share of loops that ended nearer to another period.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.9)
        axes = self.figure.subplots()
        x = result["constants"]
        (self.lags,) = axes.loglog(x, x, color=style.ORANGE, linestyle="--", label="lag, theory")
        (self.jitters,) = axes.loglog(x, x, color=style.GREEN, linestyle=":", label="3 σ, theory")
        (self.totals,) = axes.loglog(x, x, color=style.BLUE, linestyle="-", label="total, theory")
        (self.lag,) = axes.plot([], [], "s", color=style.ORANGE, label="lag, measured")
        (self.jitter,) = axes.plot([], [], "D", color=style.GREEN, label="3 σ, measured")
        (self.total,) = axes.plot(
            [], [], "o", color=style.BLACK, markersize=14, markerfacecolor="none", label="total, measured"
        )
        axes.set(xlim=(x[0], x[-1]), ylim=(3, 600), xlabel="time constant (s)", ylabel="delay error (µs)")
        axes.legend(loc="upper center", ncols=2)
        self.title = axes.set_title("")
        style.animate(self.lags, self.jitters, self.totals, self.lag, self.jitter, self.total, self.title)

    def draw(self, result):
        """Draw the measured errors, and theory if it is revealed."""
        for line, name in ((self.lags, "lags"), (self.jitters, "jitters"), (self.totals, "totals")):
            line.set_ydata(US * result[name])
            line.set_visible(result["revealed"])
        at = [result["time_constant"]]
        for dot, name in ((self.lag, "lag"), (self.jitter, "jitter3"), (self.total, "total")):
            dot.set_data(at, [np.clip(US * result[name], 3.3, 550)])
        lag, jitter, total = (US * result[name] for name in ("lag", "jitter3", "total"))
        self.title.set_text(f"Lag {lag:.0f} µs + 3 σ {jitter:.0f} µs = {total:.0f} µs")
        sentence = (
            f"At {at[0]:.2f} s the lag is {lag:.0f} µs and three sigma {jitter:.0f} µs, {total:.0f} µs in all"
            + _slipped(result["slipped"])
        )
        if not result["revealed"]:
            return sentence + "."
        return sentence + f"; theory's best is {US * result['least']:.0f} µs at {result['best']:.2f} s."


def _slipped(share):
    return f"; {100 * share:.0f} % of the loops have slipped to another period" if share > 0 else ""


class ManoeuvreView:
    """Errors of three trackers on a target that turns.

    Draws a dict with `time` (n,), s; `errors`, a dict from name to (n,), s, the same names always;
    `rms`, a dict from the same names to s; `turns`, times of the target's turns, s.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.7)
        axes = self.figure.subplots()
        self.lines = [
            axes.plot(result["time"], 0 * result["time"], color=colour, linestyle=line, label=name)[0]
            for name, (colour, line, _) in zip(result["errors"], style.LINES, strict=False)
        ]
        for turn in result["turns"]:
            axes.axvline(turn, color=style.GREY, linewidth=1)
            axes.text(turn + 0.2, 132, "turn", fontsize=9)
        axes.set(xlim=(0, result["time"][-1]), ylim=(-150, 150), xlabel="time (s)", ylabel="delay error (µs)")
        axes.legend(loc="lower left", ncols=3)
        self.title = axes.set_title("")
        style.animate(*self.lines, self.title)

    def draw(self, result):
        """Draw one record's errors; the numbers are of many."""
        for line, error in zip(self.lines, result["errors"].values(), strict=True):
            line.set_ydata(US * error)
        best = min(result["rms"], key=result["rms"].get)
        self.title.set_text(f"Smallest rms error: {best}, {US * result['rms'][best]:.0f} µs")
        shares = "; ".join(f"{name} {US * value:.1f} µs" for name, value in result["rms"].items())
        return f"Rms errors over many records: {shares}."


class FadeView:
    """Loops through a fade.

    Draws a dict with `time` (n,), s; `errors` (n, trials), s; `fade`, (start, end), s; `peak` and `cliff`, s;
    `lost`, share; `limit`, the paper's longest fade, s.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.8)
        axes = self.figure.subplots()
        self.fade = axes.axvspan(0, 1, color="#bbbbbb", alpha=0.5, label="no signal")
        (self.loops,) = axes.plot(
            [], [], color=style.BLUE, linestyle="-", linewidth=0.8, label="errors of single loops"
        )
        for at, line in ((result["peak"], "--"), (result["cliff"], ":")):
            name = "1 / (4 f₀)" if line == "--" else "1 / (2 f₀)"
            axes.axhline(US * at, color=style.ORANGE, linestyle=line, linewidth=1.4, label=name)
            axes.axhline(-US * at, color=style.ORANGE, linestyle=line, linewidth=1.4)
        axes.set(
            xlim=(0, result["time"][-1]), ylim=(-800, 1100), xlabel="time (s)", ylabel="delay error (µs)"
        )
        axes.legend(loc="upper right", ncols=2)
        self.title = axes.set_title("")
        style.animate(self.fade, self.loops, self.title)

    def draw(self, result):
        """Draw all loops as one broken line."""
        start, end = result["fade"]
        self.fade.set_x(start)
        self.fade.set_width(end - start)
        self.loops.set_data(*_one_line(result["time"], US * result["errors"].T))
        ratio = (end - start) / result["limit"]
        self.title.set_text(f"{100 * result['lost']:.0f} % of the loops are lost")
        return (
            f"After a fade of {end - start:.1f} s, {ratio:.1f} times the paper's limit of "
            f"{result['limit']:.1f} s, {100 * result['lost']:.0f} % of the loops do not come back."
        )


class CaptureView:
    """A second source crosses the target's delay.

    Draws a dict with `time` (n,), s; `crossing` (n,), s; `delays` (n, trials), s; `captured`, share;
    `power`, P_U / P_T; `speed`, s/s; `period`, 1 / f0, s.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.7)
        axes = self.figure.subplots()
        (self.loops,) = axes.plot(
            [], [], color=style.BLUE, linestyle="-", linewidth=0.8, label="single loops"
        )
        axes.axhline(0, color=style.BLACK, linestyle="-.", label="target")
        (self.other,) = axes.plot([], [], color=style.ORANGE, linestyle="--", label="false source")
        (self.stripe,) = axes.plot([], [], color=style.ORANGE, linestyle=":", label="its neighbouring stripe")
        axes.set(xlim=(-1, 1), ylim=(-1000, 1750))
        axes.set(xlabel="time, from first hearing the false source to its leaving", ylabel="delay (µs)")
        axes.set_xticks([-1, 0, 1], ["start", "crossing", "end"])
        axes.legend(loc="upper left")
        self.title = axes.set_title("")
        style.animate(self.loops, self.other, self.stripe, self.title)

    def draw(self, result):
        """Draw the loops between both sources."""
        scaled = 2 * result["time"] / result["time"][-1] - 1
        self.loops.set_data(*_one_line(scaled, US * result["delays"].T))
        self.other.set_data(scaled, US * result["crossing"])
        self.stripe.set_data(scaled, US * (result["crossing"] + result["period"]))
        self.title.set_text(f"{100 * result['captured']:.0f} % of the loops are led away")
        return (
            f"A source with {result['power']:.1f} times the target's power crosses at "
            f"{US * result['speed']:.0f} µs/s and leads {100 * result['captured']:.0f} % of the loops away."
        )


class SweepsView:
    """The discriminator display as traces, after the paper's fig. 7: time runs upwards, one sweep a line.

    Draws a dict with `offsets` (m,), s; `time` (n,), s; `sweeps` (n, m); `picks` (n,), s; `zones`, from
    name to (start, end), s.
    """

    def __init__(self, result):
        self.figure = style.figure(6.4, 6.4)
        axes = self.figure.subplots()
        (self.sweeps,) = axes.plot([], [], color=style.BLUE, linewidth=0.9, linestyle="-")
        (self.picks,) = axes.plot([], [], ".", color=style.ORANGE, label="nearest zero")
        x = US * result["offsets"]
        for name, (start, end) in result["zones"].items():
            axes.text(x[-1] + 30, (start + end) / 2, name, va="center", fontsize=10)
            axes.plot([x[-1] + 15] * 2, [start + 1, end - 1], color=style.BLACK, linewidth=3, linestyle="-")
        axes.set(xlim=(x[0], x[-1] + 240), ylim=(-4, result["time"][-1] + 16))
        axes.set(xlabel="delay of the sweep, from the manual setting (µs)", ylabel="time (s)")
        axes.set_xticks(range(-600, 601, 200))
        axes.legend(loc="upper right")
        axes.set_title("Each sweep falls through zero at the target's delay")
        style.animate(self.sweeps, self.picks)

    def draw(self, result):
        """Draw the sweeps, each around its time, and what was picked on them."""
        time, sweeps = result["time"], result["sweeps"]
        height = 1.5 * (time[1] - time[0]) / np.abs(np.percentile(sweeps, 98))
        self.sweeps.set_data(*_one_line(US * result["offsets"], time[:, None] + height * sweeps))
        self.picks.set_data(US * result["picks"], time)
        strength = {
            name: np.mean(np.std(result["sweeps"][(result["time"] >= a) & (result["time"] < b)], axis=1))
            for name, (a, b) in result["zones"].items()
        }
        weakest, strongest = min(strength, key=strength.get), max(strength, key=strength.get)
        return (
            f"{len(result['sweeps'])} sweeps of the discriminator over {np.ptp(result['time']):.0f} s: the "
            f"curves almost vanish in zone {weakest} and are strongest in zone {strongest}."
        )


class RunningAverageView:
    """A machine's running average beside the truth, after the paper's fig. 6.

    Draws a dict with `time` (n,), s; `readings`, `average`, `operator` (n,), m; `truth`, m.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.5)
        axes = self.figure.subplots()
        (self.readings,) = axes.plot([], [], ".", color=style.GREY, label="tracker's readings")
        (self.average,) = axes.plot([], [], color=style.ORANGE, linestyle="--", label="running average")
        (self.operator,) = axes.plot(
            [], [], color=style.BLUE, linestyle="-", label="line of an operator who masks"
        )
        axes.axhline(result["truth"] / 1e3, color=style.BLACK, linestyle=":", label="truth")
        axes.set(xlim=(0, result["time"][-1]), ylim=(0, 12), xlabel="time (s)", ylabel="range (km)")
        axes.legend(loc="upper left", ncols=2)
        axes.set_title("A bad stretch poisons every later average")
        style.animate(self.readings, self.average, self.operator)

    def draw(self, result):
        """Draw the readings and both averages."""
        for line, name in (
            (self.readings, "readings"),
            (self.average, "average"),
            (self.operator, "operator"),
        ):
            line.set_data(result["time"], result[name] / 1e3)
        end, line = result["average"][-1] / result["truth"] - 1, result["operator"][-1] / result["truth"] - 1
        return (
            f"At the end the machine's running average of range is {100 * end:+.0f} % off, "
            f"the operator's line {abs(100 * line):.0f} %."
        )


def _range_axis(axes, unit, ticks):
    """Make the y axis linear in unit / R and label it in kilometres, the paper's fig. 8."""
    labels = ["∞" if np.isinf(tick) else f"{tick * unit / 1e3:g}" for tick in ticks]
    axes.set_yticks([1 / tick for tick in ticks], labels)
    axes.set(ylim=(-0.1, 1.32), ylabel="range (km), on a scale of 1/R")


class ChartView:
    """The range chart alone: every second's reading on a scale that is linear in 1 / R.

    Draws a dict with `time` (n,), s; `curvature` (n,), 1/m; `unit`, m, the range at the top of the scale.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.6)
        axes = self.figure.subplots()
        (self.dots,) = axes.plot([], [], "o", color=style.BLUE, markersize=4)
        _range_axis(axes, result["unit"], PAPER_TICKS)
        axes.set(xlim=(0, result["time"][-1]), xlabel="time (s)")
        axes.set_title("On this chart, the straight line your eye draws is the right average")
        style.animate(self.dots)

    def draw(self, result):
        """Draw the readings."""
        self.dots.set_data(result["time"], result["unit"] * result["curvature"])
        shown = result["curvature"][np.isfinite(result["curvature"])]
        low, high = np.percentile(1e-3 / np.maximum(shown, 1e-9), [25, 75])
        return f"{shown.size} readings of range; half of them lie between {low:.1f} and {high:.1f} km."


class OperatorView:
    """The operator's desk: two discriminator displays and the range chart under them.

    Draws a dict with `time` (n,), `offsets` (m,), s; `curves` (2, n, m); `picks` (2, n), s, from the lines;
    `masks`, two (start, end), s; `reading`, a Reading; `unit`, m; `read_off`, m, the reader's own;
    `revealed`; `truth`, m; `machine` (n,), 1/m; `scores`, a dict from name to relative range error.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 6.5)
        *displays, chart = self.figure.subplots(3, 1, sharex=True, height_ratios=(1, 1, 1.7))
        names = "Pair 1-2", "Pair 2-3"
        both = [self._display(*each, result) for each in zip(displays, names, strict=True)]
        self.images, self.picks = zip(*both, strict=True)
        self.shades = [
            axes.axvspan(0, 0, ymax=top, facecolor="#999999", alpha=0.6)
            for axes, top in zip((*displays, chart), (1, 1, 0.8), strict=True)
            for _ in range(2)
        ]
        style.animate(*self.shades)
        self._chart(chart, result)

    def _display(self, axes, name, result):
        """One pair's picture: the image, and the dots of the picks."""
        time, offsets = result["time"], 1e3 * result["offsets"]
        size = 1.8 * np.median(np.abs(result["curves"]))
        image = axes.imshow(
            result["curves"][0].T, cmap=colormaps[style.FIELD_MAP].resampled(20), aspect="auto",
            extent=(time[0] - 0.5, time[-1] + 0.5, offsets[0], offsets[-1]), origin="lower",
            interpolation="nearest", vmin=-size, vmax=size,
        )  # fmt: skip
        line = axes.axhline(0, color="white", linewidth=1.2, linestyle="--")
        (dots,) = axes.plot(
            [], [], "o", color="white", markersize=3.5, markeredgecolor="black", markeredgewidth=0.6
        )
        axes.set(ylabel="offset from\nyour line (ms)")
        axes.set_title(f"{name}: upwards, bright turns to dark at the target", fontsize=10)
        axes.grid(False)
        style.animate(image, line, dots)
        return image, dots

    def _chart(self, axes, result):
        (self.used,) = axes.plot([], [], "o", color=style.BLUE, markersize=4, label="seconds kept")
        (self.struck,) = axes.plot(
            [], [], "o", color=style.GREY, markersize=4, markerfacecolor="none", label="struck out"
        )
        (self.line,) = axes.plot([], [], color=style.BLACK, linestyle="-", label="line through those kept")
        (self.mine,) = axes.plot([], [], color=style.ORANGE, linestyle="--", label="the range you read")
        (self.machine,) = axes.plot([], [], color=style.GREEN, linestyle="-.", label="machine (when shown)")
        (self.truth,) = axes.plot(
            [], [], color=style.PINK, linestyle=":", linewidth=3, label="truth (when shown)"
        )
        _range_axis(axes, result["unit"], DESK_TICKS)
        axes.set(xlim=(result["time"][0] - 0.5, result["time"][-1] + 0.5), xlabel="time (s)")
        axes.legend(loc="upper left", ncols=3)
        style.animate(self.used, self.struck, self.line, self.mine, self.machine, self.truth)

    def draw(self, result):
        """Draw the displays around the lines, the masks, and the chart."""
        time, reading, unit = result["time"], result["reading"], result["unit"]
        for image, dots, curves, picks in zip(
            self.images, self.picks, result["curves"], result["picks"], strict=True
        ):
            image.set_data(curves.T)
            dots.set_data(time, 1e3 * picks)
        for number, shade in enumerate(self.shades):
            start, end = result["masks"][number % 2]
            shade.set_x(start)
            shade.set_width(end - start)
        scaled = unit * reading.curvature
        self.used.set_data(time[reading.keep], scaled[reading.keep])
        self.struck.set_data(time[~reading.keep], scaled[~reading.keep])
        self.line.set_data(time, unit * reading.line)
        self.mine.set_data(time[[0, -1]], [unit / result["read_off"]] * 2)
        for line, values in (
            (self.machine, result["machine"]),
            (self.truth, np.full(time.size, 1 / result["truth"])),
        ):
            line.set_data(time, unit * values if result["revealed"] else np.full(time.size, np.nan))
        return self._sentence(result)

    @staticmethod
    def _sentence(result):
        reading = result["reading"]
        kept = np.count_nonzero(reading.keep)
        says = "no range" if np.isnan(reading.target_range) else f"{reading.target_range / 1e3:.2f} km"
        sentence = (
            f"{kept} of {reading.keep.size} s are kept and their line says {says}; you read "
            f"{result['read_off'] / 1e3:.2f} km."
        )
        if kept:
            first, second = (US * np.sqrt(np.nanmean(p[reading.keep] ** 2)) for p in result["picks"])
            sentence = (
                f"The dots lie {first:.0f} µs (1-2) and {second:.0f} µs (2-3) from your lines; {sentence}"
            )
        if not result["revealed"]:
            return sentence
        scores = "; ".join(
            f"{name} " + ("no range" if np.isnan(error) else f"{round(100 * error, 1) + 0.0:+.1f} %")
            for name, error in result["scores"].items()
        )
        return f"{sentence} The truth is {result['truth'] / 1e3:.2f} km. Errors: {scores}."
