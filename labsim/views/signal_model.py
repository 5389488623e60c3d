"""The pictures of chapter 01: what a vector sensor hears from a passing vessel."""

import numpy as np

from labsim.views import style

MAP_LIMITS = {"xlim": (-420, 620), "ylim": (-400, 400)}
ZOOM = 16.0
ROUND = 0.8


class RecordView:
    """Wu & Hu 2010, figures 2 and 3, with a spectrogram between them.

    Draws a dict with `time` (n,) s and `pressure` (n,); `frequency` (f,) Hz and `level_db` (f, m),
    the columns evenly over the record; `window_time`, `measured_db`, `expected_db` (windows,); `closest` s.
    """

    def __init__(self):
        self.figure = style.figure(9, 7.2)
        self.wave, self.image, self.curve = self.figure.subplots(3, 1, sharex=True)
        (self.trace,) = self.wave.plot([], [], color=style.BLUE, linewidth=0.6)
        self.wave.set(xlim=(0, 60), ylim=(-5, 5))
        self.wave.set_ylabel("pressure (root mean square of\nthe signal at closest = 1)")
        self.wave.set_title("Figure 2: the sound swells and fades as the vessel passes")
        self.field = self.image.imshow(
            np.zeros((2, 2)), origin="lower", aspect="auto", cmap=style.FIELD_MAP, vmin=-12, vmax=20
        )
        self.image.set(ylabel="frequency (Hz)", ylim=(0, 1000))
        self.image.grid(False)
        self.image.set_title("The same as a spectrogram: all frequencies of the band swell together")
        self.figure.colorbar(self.field, ax=self.image, label="level over noise (dB)", pad=0.01)
        (self.dots,) = self.curve.plot([], [], ".", color=style.BLUE, label="each window, measured")
        (self.line,) = self.curve.plot([], [], "--", color=style.ORANGE, label="1/r² law")
        (self.mark,) = self.curve.plot([], [], ":", color=style.BLACK, label="closest approach, as heard")
        self.curve.set(xlabel="time (s)", ylabel="SNR (dB)", ylim=(0, 18))
        self.curve.set_title("Figure 3: the signal-to-noise ratio is the distance, turned upside down")
        self.curve.legend(loc="upper right")
        style.animate(self.trace, self.field, self.dots, self.line, self.mark)

    def draw(self, result):
        """Draw the whole record; return the sentence."""
        block = result["pressure"].size // 600
        bars = result["pressure"][: 600 * block].reshape(600, block)
        ends = np.stack([bars.min(axis=1), bars.max(axis=1)], axis=1).ravel()
        self.trace.set_data(np.repeat(result["time"][: 600 * block : block], 2), ends)
        self.field.set_data(result["level_db"])
        self.field.set_extent((0, result["time"][-1], 0, result["frequency"][-1]))
        self.image.set(xlim=(0, 60), ylim=(0, 1000))
        self.dots.set_data(result["window_time"], result["measured_db"])
        self.line.set_data(result["window_time"], result["expected_db"])
        self.mark.set_data([result["closest"]] * 2, [0, 18])
        top, last = result["expected_db"].max(), result["expected_db"][-1]
        return (
            f"The SNR peaks at {top:.1f} dB when the closest approach is heard, after "
            f"{result['closest']:.1f} s, and has fallen to {last:.1f} dB at the end of the minute."
        )


class HodographView:
    """Velocity against velocity, and pressure times velocity, over half a second.

    Draws a dict with `velocity` (n, 3), `pressure` (n,), `axis` (rad, long axis of the cloud, either end),
    `slim` (short over long axis of the cloud), `estimate` and `truth` (azimuths, rad).
    """

    def __init__(self):
        self.figure = style.figure(9, 4.9)
        self.cloud, self.product = self.figure.subplots(1, 2)
        (self.points,) = self.cloud.plot([], [], ".", markersize=2, color=style.GREY)
        (self.line,) = self.cloud.plot([], [], "-", color=style.BLUE, label="long axis: two ends")
        self.cloud.set(xlabel="velocity along x (rms = 1)", ylabel="velocity along y (rms = 1)")
        self.cloud.set_title("Velocity alone: a line, but which end?")
        (self.flow,) = self.product.plot([], [], ".", markersize=2, color=style.GREY)
        (self.ray,) = self.product.plot([], [], "-", color=style.BLUE, label="mean product: one end")
        self.product.set(xlabel="pressure × velocity along x (rms = 1)")
        self.product.set(ylabel="pressure × velocity along y (rms = 1)")
        self.product.set_title("Times pressure: the cloud leans one way")
        rays = []
        for axes in (self.cloud, self.product):
            axes.set(xlim=(-4, 4), ylim=(-4, 4), aspect="equal")
            rays += axes.plot([], [], "--", color=style.ORANGE, label="true azimuth")
            axes.legend(loc="lower right")
        self.truths = rays
        style.animate(self.points, self.line, self.flow, self.ray, *rays)

    def draw(self, result):
        """Show one half second; return the sentence."""
        velocity = result["velocity"][:, :2]
        self.points.set_data(*(velocity / np.sqrt(np.mean(np.sum(velocity**2, axis=1)) / 2)).T)
        flow = result["pressure"][:, None] * velocity
        self.flow.set_data(*(flow / np.sqrt(np.mean(np.sum(flow**2, axis=1)) / 2)).T)
        self.line.set_data(*(_along(result["axis"]) * [-6, 6]))
        self.ray.set_data(*(_along(result["estimate"]) * [0, 6]))
        for ray in self.truths:
            ray.set_data(*(_along(result["truth"]) * [0, 6]))
        one, estimate, truth = np.degrees([result["axis"], result["estimate"], result["truth"]]) % 360
        one = round(one) % 180
        cloud = f"The velocities line up along {one}° or {one + 180}°"
        if result["slim"] > ROUND:
            cloud = "The cloud is a disc: no direction can be read from it"
        return (
            f"{cloud}; with pressure the sensor decides for {estimate:.1f}°, "
            f"and the vessel is heard from {truth:.1f}°."
        )


class RetardationView:
    """Where the vessel is and where it is heard, and the bearing error of believing the two the same.

    Draws a dict with `track` (m, 2), `now` (2,), `heard` (2,), `delay` s; `time` (windows,),
    `error_deg` (windows,) measured, `expected_deg` (windows,); `moment` s; `corrected` True or False.
    """

    def __init__(self):
        self.figure = style.figure(9, 4.2)
        self.map, self.curve = self.figure.subplots(1, 2, width_ratios=(6, 5))
        (self.track,) = self.map.plot([], [], ":", color=style.GREY, label="track")
        self.map.plot(0, 0, "^", color=style.BLACK, markersize=9, label="sensor")
        (self.now,) = self.map.plot([], [], "s", color=style.ORANGE, markersize=9, label="is now")
        self.now.set(markerfacecolor="none", markeredgewidth=2)
        (self.heard,) = self.map.plot([], [], "o", color=style.BLUE, markersize=5, label="is heard")
        (self.path,) = self.map.plot([], [], "--", color=style.BLUE, linewidth=1)
        self.map.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", xlim=(-420, 980), ylim=(-640, 400))
        self.map.legend(loc="lower left")
        self.map_title = self.map.set_title("You hear where it was")
        self.zoom = self.map.inset_axes((0.6, 0.04, 0.38, 0.36), xlim=(-ZOOM, ZOOM), ylim=(-ZOOM, ZOOM))
        self.zoom.set(xticks=[], yticks=[])
        self.zoom.spines[:].set_visible(True)
        self.zoom.set_title(f"{2 * ZOOM:.0f} m about the vessel", fontsize=9, fontweight="normal")
        (self.near_now,) = self.zoom.plot(0, 0, "s", color=style.ORANGE, markersize=9)
        self.near_now.set(markerfacecolor="none", markeredgewidth=2)
        (self.near_heard,) = self.zoom.plot([], [], "o", color=style.BLUE, markersize=5)
        (self.near_track,) = self.zoom.plot([], [], ":", color=style.GREY)
        (self.dots,) = self.curve.plot([], [], ".", color=style.BLUE, label="averaged intensity")
        (self.line,) = self.curve.plot([], [], "--", color=style.ORANGE, label="expected")
        (self.mark,) = self.curve.plot([], [], ":", color=style.BLACK)
        self.curve.set(xlabel="time (s)", ylabel="azimuth error (°)", xlim=(0, 60), ylim=(-2, 2))
        self.curve.legend(loc="lower right")
        self.curve_title = self.curve.set_title("Azimuth error")
        style.animate(self.track, self.now, self.heard, self.path, self.dots, self.line, self.mark)
        style.animate(self.map_title, self.curve_title, self.near_heard, self.near_track)

    def draw(self, result):
        """Show one moment and the errors of the whole minute; return the sentence."""
        self.track.set_data(*result["track"].T)
        self.now.set_data(*result["now"][:, None])
        self.heard.set_data(*result["heard"][:, None])
        self.path.set_data(*np.stack([result["heard"], [0, 0]], axis=1))
        self.near_heard.set_data(*(result["heard"] - result["now"])[:, None])
        self.near_track.set_data(*(result["track"] - result["now"]).T)
        self.dots.set_data(result["time"], result["error_deg"])
        self.line.set_data(result["time"], result["expected_deg"])
        self.mark.set_data([result["moment"]] * 2, [-2, 2])
        behind = np.linalg.norm(result["now"] - result["heard"])
        self.map_title.set_text(f"Heard as it was {result['delay']:.2f} s ago, {behind:.1f} m behind")
        reference = "where it was" if result["corrected"] else "where it is"
        self.curve_title.set_text(f"Error against {reference}")
        worst = result["expected_deg"][np.argmax(np.abs(result["expected_deg"]))]
        return (
            f"At {result['moment']:.0f} s the sound heard left {behind:.1f} m behind the vessel; measured "
            f"against {reference}, the bearings are off by up to {abs(worst):.2f}° besides the noise."
        )


class LevelView:
    """A track seen from above and the SNR it gives against time, with the paper's vessel for comparison.

    Draws a dict with `track` (m, 2), `time` (n,) s, `snr_db` (n,), `closest` s, `closest_range` m,
    `width` s (time within 3 dB of the peak); the first such dict, given to the view, stays as comparison.
    """

    def __init__(self, reference):
        self.figure = style.figure(9, 4.2)
        self.map, self.curve = self.figure.subplots(1, 2, width_ratios=(6, 5))
        self.map.plot(*reference["track"].T, "--", color=style.ORANGE, label="the paper's vessel")
        self.map.plot(0, 0, "^", color=style.BLACK, markersize=9, label="sensor")
        (self.track,) = self.map.plot([], [], "-", color=style.BLUE, label="this vessel")
        (self.begin,) = self.map.plot([], [], "o", color=style.BLUE, markersize=7, label="where it begins")
        self.map.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", **MAP_LIMITS)
        self.map.set_title("One minute, seen from above")
        self.curve.plot(
            reference["time"], reference["snr_db"], "--", color=style.ORANGE, label="the paper's vessel"
        )
        (self.line,) = self.curve.plot([], [], "-", color=style.BLUE, label="this vessel")
        (self.mark,) = self.curve.plot([], [], "v", color=style.BLACK, label="closest approach")
        self.curve.set(xlabel="time (s)", ylabel="SNR (dB)", xlim=(0, 60), ylim=(-12, 42))
        handles, names = self.map.get_legend_handles_labels()
        self.figure.legend(
            [*handles, self.mark], [*names, "closest approach"], loc="outside lower center", ncols=5
        )
        self.title = self.curve.set_title("Loudness is distance")
        style.animate(self.track, self.begin, self.line, self.mark, self.title)

    def draw(self, result):
        """Show one vessel; return the sentence."""
        self.track.set_data(*result["track"].T)
        self.begin.set_data(*result["track"][:1].T)
        self.line.set_data(result["time"], result["snr_db"])
        peak = result["snr_db"].max()
        self.mark.set_data([result["closest"]], [peak])
        self.title.set_text(f"Peak {peak:.1f} dB, within 3 dB of it for {result['width']:.0f} s")
        return (
            f"Heard closest after {result['closest']:.1f} s from {result['closest_range']:.0f} m, the vessel "
            f"reaches {peak:.1f} dB and stays within 3 dB of that for {result['width']:.1f} s."
        )


class EdgeView:
    """The spectrum about the upper edge of the vessel's band, which Doppler moves.

    Draws a dict with `frequency` (f,) Hz, `level_db` (f,) over the level in the band,
    `edge` Hz (where the edge should be), `moment` s, `range_rate` m/s.
    """

    def __init__(self, edge):
        self.edge = edge
        self.figure = style.figure(9, 3.8)
        self.axes = self.figure.subplots()
        (self.line,) = self.axes.plot([], [], "-", color=style.BLUE, linewidth=1.2, label="spectrum heard")
        self.axes.axvline(edge, color=style.BLACK, linestyle=":", label="edge on board")
        (self.mark,) = self.axes.plot([], [], "--", color=style.ORANGE, label="edge as Doppler predicts")
        self.axes.set(xlabel="frequency (Hz)", ylabel="level over the band (dB)", ylim=(-40, 8))
        self.axes.set_xlim(edge - 40, edge + 40)
        self.axes.legend(loc="lower left")
        self.title = self.axes.set_title("Doppler moves the edge of the band")
        style.animate(self.line, self.mark, self.title)

    def draw(self, result):
        """Show one moment; return the sentence."""
        self.line.set_data(result["frequency"], result["level_db"])
        self.mark.set_data([result["edge"]] * 2, [-40, 8])
        shift = result["edge"] - self.edge
        speed = abs(result["range_rate"])
        way = f"is {'coming closer' if result['range_rate'] < 0 else 'going away'} at {speed:.1f} m/s"
        if speed < 0.05:
            way = "keeps its distance"
        self.title.set_text(f"After {result['moment']:.1f} s Doppler has moved the edge by {shift:+.1f} Hz")
        return (
            f"After {result['moment']:.1f} s the vessel {way}, "
            f"and the edge of its band is heard at {result['edge']:.1f} Hz."
        )


def _along(angle):
    return np.array([[np.cos(angle)], [np.sin(angle)]])
