"""The pictures of chapter 02: how well averaged intensity points."""

import numpy as np
from matplotlib.ticker import FuncFormatter, NullFormatter

from labsim.views import style

FLOOR, CEILING = 0.03, 300
PLAIN = FuncFormatter(lambda value, _: f"{value:g}")


class ErrorView:
    """Wu & Hu 2010, figure 4: the errors of azimuth and angle from the vertical against time.

    Draws a dict with `time` (n,) s, and in degrees, for azimuth and angle: `one` (2, n), the absolute error
    of one record, `rmse` (2, n) over `trials` records, and `expected` (2, n).
    """

    def __init__(self):
        self.figure = style.figure(9, 4.2)
        self.panels = self.figure.subplots(1, 2, sharey=True)
        self.artists, self.titles = [], []
        for axes in self.panels:
            (dots,) = axes.plot([], [], ".", color=style.GREY, markersize=4, label="one record, |error|")
            (line,) = axes.plot([], [], "-", color=style.BLUE, label="RMSE over records")
            (dash,) = axes.plot([], [], "--", color=style.ORANGE, label="expected")
            (mark,) = axes.plot([], [], "v", color=style.BLACK, markersize=8, label="least expected")
            axes.set(xlabel="time (s)", xlim=(0, 60), yscale="log", ylim=(0.005, 50))
            self.artists.append((dots, line, dash, mark))
            self.titles.append(axes.set_title("error"))
            style.animate(dots, line, dash, mark, self.titles[-1])
            _plain(axes.yaxis)
        self.panels[0].set_ylabel("error (°)")
        handles, names = self.panels[1].get_legend_handles_labels()
        self.figure.legend(handles, names, loc="outside lower center", ncols=4)

    def draw(self, result):
        """Show the errors of one scene; return the sentence."""
        time, words = result["time"], []
        for which, name in enumerate(("Azimuth", "Angle from vertical")):
            dots, line, dash, mark = self.artists[which]
            expected, measured = result["expected"][which], result["rmse"][which]
            dots.set_data(time, result["one"][which])
            line.set_data(time, measured)
            dash.set_data(time, expected)
            best = np.argmin(expected)
            mark.set_data([time[best]], [expected[best]])
            self.titles[which].set_text(f"{name}: least error near {time[best]:.0f} s")
            words.append(
                f"{name.lower()} {style.two_digits(measured[best])}° near {time[best]:.0f} s "
                f"and {style.two_digits(measured[-1])}° last"
            )
        return f"RMSE over {result['trials']} records: {'; '.join(words)}."


class RegimeView:
    """RMSE of the angle against SNR, with theory and bound, and the three regimes.

    Draws a dict with `snr_db` (n,), `measured` (n,) deg; `curve_db` (m,) and `expected`, `bound`, `simple`
    (m,) deg; `cliff_db`, where the expected error reaches a fifth of a radian.
    """

    def __init__(self):
        self.figure = style.figure(9, 4.6)
        self.axes = self.figure.subplots()
        (self.simple,) = self.axes.plot(
            [], [], "-", color=style.GREY, linewidth=1, label="a factor of 10 for 20 dB"
        )
        (self.expected,) = self.axes.plot([], [], "--", color=style.ORANGE, label="closed form")
        (self.bound,) = self.axes.plot([], [], ":", color=style.BLACK, label="Cramér-Rao bound (later)")
        (self.points,) = self.axes.plot([], [], "o", color=style.BLUE, label="averaged intensity, simulated")
        (self.cliff,) = self.axes.plot([], [], "-.", color=style.GREEN, linewidth=1.2)
        (self.knee,) = self.axes.plot([0, 0], [FLOOR, CEILING], "-.", color=style.GREEN, linewidth=1.2)
        top = {"y": 0.7 * CEILING, "ha": "center", "va": "top", "fontsize": 9}
        self.names = [
            self.axes.text(x=0, s=name, **top) for name in ("cliff", "noise × noise", "signal × noise")
        ]
        self.axes.set(xlabel="SNR of the pressure (dB)", ylabel="RMSE of the angle from the vertical (°)")
        self.axes.set(xlim=(-21, 31), yscale="log", ylim=(FLOOR, CEILING))
        _plain(self.axes.yaxis)
        self.axes.legend(loc="upper right", bbox_to_anchor=(1, 0.92))
        self.title = self.axes.set_title("Three regimes")
        style.animate(self.simple, self.expected, self.bound, self.points, self.cliff, self.knee)
        style.animate(self.title, *self.names)

    def draw(self, result):
        """Show one set of window, bandwidth and noise; return the sentence."""
        for name in ("simple", "expected"):
            getattr(self, name).set_data(result["curve_db"], result[name])
        meant = result["curve_db"] >= result["cliff_db"]
        self.bound.set_data(result["curve_db"][meant], result["bound"][meant])
        self.points.set_data(result["snr_db"], result["measured"])
        cliff = np.clip(result["cliff_db"], -21, 31)
        self.cliff.set_data([cliff, cliff], [FLOOR, CEILING])
        edges = np.array([-21, cliff, max(cliff, 0), 31])
        for text, left, right in zip(self.names, edges[:-1], edges[1:], strict=True):
            text.set_x((left + right) / 2)
            text.set_visible(right - left > 6)
        self.title.set_text(f"The formula fails below {result['cliff_db']:.0f} dB")
        ten = np.argmin(np.abs(result["snr_db"] - 10))
        return (
            f"At {result['snr_db'][ten]:.0f} dB the measured RMSE is {result['measured'][ten]:.2f}°; "
            f"below about {result['cliff_db']:.0f} dB the expected error exceeds a fifth of a radian "
            "and the law no longer holds."
        )


class OverheadView:
    """Estimated directions seen from above, and azimuth error against error on the sphere.

    Draws a dict with `estimates` (n, 3) unit vectors, `truth` (3,), `angle_deg`; `azimuth_rmse`,
    `sphere_rmse` deg, measured; `angles_deg` (m,), `azimuth_curve`, `sphere_curve` (m,) deg, expected.
    """

    def __init__(self):
        self.figure = style.figure(9, 4.5)
        self.sky, self.curve = self.figure.subplots(1, 2, width_ratios=(4, 5))
        turn = np.linspace(0, 2 * np.pi, 200)
        self.sky.plot(np.cos(turn), np.sin(turn), "-", color=style.BLACK, linewidth=1, label="horizon")
        self.sky.plot(0, 0, "+", color=style.BLACK, markersize=10, label="overhead")
        (self.cloud,) = self.sky.plot([], [], ".", color=style.BLUE, markersize=3, label="estimates")
        (self.star,) = self.sky.plot([], [], "s", color=style.ORANGE, markersize=9, label="source")
        self.star.set(markerfacecolor="none", markeredgewidth=2)
        self.sky.set(
            xlabel="a along x", ylabel="a along y", aspect="equal", xlim=(-1.1, 1.1), ylim=(-1.6, 1.1)
        )
        self.sky.set_title("Directions seen from above")
        self.sky.legend(loc="lower left", ncols=2)
        (self.azimuth,) = self.curve.plot([], [], "--", color=style.ORANGE, label="azimuth")
        (self.sphere,) = self.curve.plot([], [], "-", color=style.BLUE, label="on the sphere")
        (self.azimuth_now,) = self.curve.plot([], [], "s", color=style.ORANGE)
        (self.sphere_now,) = self.curve.plot([], [], "o", color=style.BLUE)
        self.curve.set(xlabel="angle from the vertical (°)", ylabel="RMSE (°)", xlim=(0, 90))
        self.curve.set(yscale="log", ylim=(0.05, 200))
        _plain(self.curve.yaxis)
        self.curve.legend(loc="upper right")
        self.title = self.curve.set_title("Azimuth error")
        style.animate(self.cloud, self.star, self.azimuth, self.sphere)
        style.animate(self.azimuth_now, self.sphere_now, self.title)

    def draw(self, result):
        """Show one direction; return the sentence."""
        self.cloud.set_data(*result["estimates"].T[:2])
        self.star.set_data(*result["truth"][:2, None])
        self.azimuth.set_data(result["angles_deg"], result["azimuth_curve"])
        self.sphere.set_data(result["angles_deg"], result["sphere_curve"])
        angle, azimuth, sphere = (result[name] for name in ("angle_deg", "azimuth_rmse", "sphere_rmse"))
        self.azimuth_now.set_data([angle], [azimuth])
        self.sphere_now.set_data([angle], [sphere])
        self.title.set_text(f"Azimuth errs {azimuth / sphere:.1f} times as much as the direction")
        return (
            f"At {angle:.1f}° from the vertical the azimuth errs by {azimuth:.2f}° (RMSE), "
            f"the direction on the sphere by {sphere:.2f}° in each of its two ways."
        )


class WindowView:
    """Azimuth error against the length of the window for a moving source.

    Windows tried before stay as grey dots until anything but the window changes.
    Draws a dict with `window` (k,) s and `measured` (k,) deg, or one of each; `windows` (m,) s
    and `noise`, `lag`, `total` (m,) deg; `best` s; `revealed`, whether to show the curves.
    """

    def __init__(self):
        self.figure = style.figure(9, 4.4)
        self.axes = self.figure.subplots()
        (self.noise,) = self.axes.plot([], [], "--", color=style.ORANGE, label="noise")
        (self.lag,) = self.axes.plot([], [], "-.", color=style.GREEN, label="motion")
        (self.total,) = self.axes.plot([], [], "-", color=style.GREY, label="both, closed form")
        (self.best,) = self.axes.plot([], [], ":", color=style.BLACK, label="best window, closed form")
        (self.tried,) = self.axes.plot([], [], "o", color=style.GREY, markersize=6, label="tried before")
        (self.point,) = self.axes.plot([], [], "o", color=style.BLUE, markersize=9, label="simulated")
        self.scene, self.visited = None, {}
        self.axes.set(xlabel="window (s)", ylabel="azimuth RMSE (°)", xscale="log", yscale="log")
        self.axes.set(xlim=(0.05, 20), ylim=(0.02, 60))
        _plain(self.axes.xaxis)
        _plain(self.axes.yaxis)
        self.axes.add_artist(self.axes.legend(handles=[self.point, self.tried], loc="upper left"))
        closed_form = [self.noise, self.lag, self.total, self.best]
        self.key = self.axes.legend(handles=closed_form, loc="upper right", ncols=2)
        self.title = self.axes.set_title("Azimuth error")
        style.animate(*closed_form, self.tried, self.point, self.key, self.title)

    def draw(self, result):
        """Show one window; return the sentence."""
        shown = 1.0 if result["revealed"] else np.nan
        for name in ("noise", "lag", "total"):
            getattr(self, name).set_data(result["windows"], shown * result[name])
        self.best.set_data([result["best"] * shown] * 2, [0.02, 10])
        self.key.set_visible(bool(result["revealed"]))
        window, measured = np.atleast_1d(result["window"]), np.atleast_1d(result["measured"])
        if not np.array_equal(self.scene, result["total"]):
            self.scene, self.visited = result["total"], {}
        self.tried.set_data(list(self.visited), list(self.visited.values()))
        self.visited |= dict(zip(window.tolist(), measured.tolist(), strict=True))
        self.point.set_data(window, measured)
        self.title.set_text(f"A window of {window[-1]:.2g} s errs by {measured[-1]:.2f}°")
        reveal = (
            f"; the closed form puts the best window at {result['best']:.1f} s" if result["revealed"] else ""
        )
        seen = f"With a window of {window[-1]:.2g} s the azimuth RMSE is {measured[-1]:.2f}°"
        return f"{seen}{reveal}."


class ContestView:
    """Averaged intensity against the maximum-likelihood direction, both over the Cramér-Rao bound.

    Draws a dict with `snr_db` (n,), `intensity`, `likeliest` (n,): RMSE over the bound; `curve_db`, `curve`
    (m,): the closed form for intensity; `ratio`: Nv / Np.
    """

    def __init__(self):
        self.figure = style.figure(9, 4.4)
        self.axes = self.figure.subplots()
        self.axes.axhline(1, color=style.BLACK, linestyle=":", label="Cramér-Rao bound")
        (self.curve,) = self.axes.plot([], [], "--", color=style.ORANGE, label="intensity, closed form")
        (self.intensity,) = self.axes.plot([], [], "s", color=style.ORANGE, label="intensity, simulated")
        (self.likeliest,) = self.axes.plot(
            [], [], "o", color=style.BLUE, label="maximum likelihood, simulated"
        )
        self.axes.set(xlabel="SNR of the pressure (dB)", ylabel="RMSE over the bound", yscale="log")
        ticks = (1, 1.5, 2, 3, 5)
        self.axes.set(xlim=(-7, 22), ylim=(0.8, 8), yticks=ticks, yticklabels=[f"{tick:g}" for tick in ticks])
        self.axes.minorticks_off()
        self.axes.legend(loc="upper right")
        self.title = self.axes.set_title("Contest")
        style.animate(self.curve, self.intensity, self.likeliest, self.title)

    def draw(self, result):
        """Show one pair of noises; return the sentence."""
        self.curve.set_data(result["curve_db"], result["curve"])
        self.intensity.set_data(result["snr_db"], result["intensity"])
        self.likeliest.set_data(result["snr_db"], result["likeliest"])
        zero = np.argmin(np.abs(result["snr_db"]))
        one, other = result["intensity"][zero], result["likeliest"][zero]
        self.title.set_text(f"At 0 dB: intensity {one:.2f}, maximum likelihood {other:.2f} times the bound")
        return (
            f"With velocity noise {result['ratio']:.2g} times the pressure noise, at 0 dB, "
            f"averaged intensity errs by {one:.2f} times the bound and maximum likelihood by {other:.2f}."
        )


def _plain(axis):
    axis.set_major_formatter(PLAIN)
    axis.set_minor_formatter(NullFormatter())
