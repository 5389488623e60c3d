"""Pictures of notebook 10: a recorded track heard from afar and met by echoes; a recording's directions."""

import numpy as np

from labsim.metrics import angle_difference, rmse
from labsim.views import style


class ArrayView:
    """A recorded track with the points that bearing and range ratio draw, and the course against time.

    Made for the track (m, 2), m, as the sensor of the first part sees it, and its duration, s. Draws a dict
    with `points` (k, 2), m, on the same map; `time` (n,), s, `course_deg` and `true_course_deg` (n,);
    `distance_km`, `bearing_std_deg`.
    """

    def __init__(self, track, duration):
        self.figure = style.figure(9, 4.2)
        self.map, self.curve = self.figure.subplots(1, 2)
        _track_map(self.map, track)
        (self.points,) = self.map.plot([], [], ".", color=style.BLUE, label="bearing × range ratio")
        self.map.legend(loc="lower right")
        (self.true,) = self.curve.plot([], [], "--", color=style.ORANGE, label="recorded track")
        (self.course,) = self.curve.plot([], [], "o", markersize=4, color=style.BLUE, label="estimate")
        self.curve.set(
            xlabel="time (s)", ylabel="course from x (°)", ylim=(-180, 180), yticks=range(-180, 181, 60)
        )
        self.curve.set_xlim(0, duration)
        self.curve.legend(loc="lower left")
        self.titles = [axes.set_title(" ") for axes in (self.map, self.curve)]
        style.animate(self.points, self.true, self.course, *self.titles)

    def draw(self, result):
        """Show one distance; return the sentence."""
        time = result["time"]
        self.points.set_data(*result["points"].T)
        self.true.set_data(time, result["true_course_deg"])
        self.course.set_data(time, result["course_deg"])
        off = np.radians(result["course_deg"]) - np.radians(result["true_course_deg"])
        off = np.degrees(np.median(np.abs(angle_difference(off, 0))))
        self.titles[0].set_text(f"Heard from {result['distance_km']:.1f} km to the south")
        self.titles[1].set_text(f"Course wrong by {off:.0f}° (median)")
        return (
            f"From {result['distance_km']:.1f} km, with bearings wrong by {result['bearing_std_deg']:.2g}°, "
            f"half of the windows give the course to {off:.0f}° or better."
        )


class EchoView:
    """A recorded track met by echoes: what was located, what the filter reports, and how far off it is.

    Made for the track (m, 2), m, and the time of the last ping, s. Draws a dict with
    `located` (n, 2) and `from_target` (n,), the echoes of all pings; `reported` list of (m, 2), one a ping;
    `time` and `true` (k, 2); `weight` (k,), the expected number of targets; `clutter`.
    """

    def __init__(self, track, duration):
        self.figure = style.figure(9, 4.4)
        self.map, self.curve = self.figure.subplots(1, 2)
        _track_map(self.map, track, margin=350)
        (self.clutter,) = self.map.plot([], [], "x", color=style.GREY, markersize=4, label="false alarms")
        (self.echoes,) = self.map.plot(
            [], [], "s", color=style.PINK, markersize=5, label="echoes of the vessel"
        )
        (self.found,) = self.map.plot([], [], "o", color=style.BLUE, markersize=5, label="reported")
        self.found.set(markerfacecolor="none", markeredgewidth=1.6)
        self.map.legend(loc="lower right", fontsize=8)
        (self.weight,) = self.curve.plot([], [], "-", color=style.BLUE, label="expected number of targets")
        (self.count,) = self.curve.plot([], [], "s", color=style.ORANGE, label="targets reported")
        self.count.set(markerfacecolor="none")
        self.curve.axhline(1, color=style.BLACK, linestyle=":", label="truth: one vessel")
        self.curve.set(xlabel="time (s)", ylabel="number of targets", ylim=(-0.1, 4), yticks=range(5))
        self.curve.set_xlim(-3, duration + 3)
        self.curve.legend(loc="upper right")
        self.titles = [axes.set_title(" ") for axes in (self.map, self.curve)]
        style.animate(self.clutter, self.echoes, self.found, self.weight, self.count, *self.titles)

    def draw(self, result):
        """Show one run; return the sentence."""
        time, mine = result["time"], result["from_target"]
        self.clutter.set_data(*result["located"][~mine].T)
        self.echoes.set_data(*result["located"][mine].T)
        self.found.set_data(*np.concatenate(result["reported"]).T)
        self.weight.set_data(time, result["weight"])
        self.count.set_data(time, [len(states) for states in result["reported"]])
        near = [
            np.linalg.norm(states - true, axis=1).min() if len(states) else np.inf
            for states, true in zip(result["reported"], result["true"], strict=True)
        ]
        held = np.array(near) < 200
        off = f"{np.median(np.array(near)[held]):.0f} m" if held.any() else "nothing"
        self.titles[0].set_text(
            f"{np.count_nonzero(mine)} echoes among {np.count_nonzero(~mine)} false alarms"
        )
        self.titles[1].set_text(f"Held on {held.sum()} of {held.size} pings")
        return (
            f"With {result['clutter']:.0f} false alarms a ping the filter reports the vessel on {held.sum()} "
            f"of {held.size} pings (within 200 m), typically {off} away from it."
        )


class DirectionsView:
    """The two angles of a recording against time, and the positions that they and the depth give.

    Draws a dict with `time` (n,), s; `azimuth_deg`, `angle_deg` (n,), measured; `true_azimuth_deg`,
    `true_angle_deg` (n,); `points` and `track` (n, 2), m; `window`, s; `order`.
    """

    def __init__(self, duration):
        self.figure = style.figure(9, 4.4)
        grid = self.figure.add_gridspec(2, 2)
        self.map = self.figure.add_subplot(grid[:, 1])
        self.panels = [self.figure.add_subplot(grid[0, 0])]
        self.panels.append(self.figure.add_subplot(grid[1, 0], sharex=self.panels[0]))
        self.dots = [axes.plot([], [], "o", ms=4, color=style.BLUE)[0] for axes in self.panels]
        self.truths = [axes.plot([], [], "--", color=style.ORANGE)[0] for axes in self.panels]
        self.panels[0].set(
            ylabel="azimuth (°)", ylim=(-180, 180), yticks=range(-180, 181, 90), xlim=(0, duration)
        )
        self.panels[1].set(
            ylabel="from vertical (°)", ylim=(0, 180), yticks=range(0, 181, 45), xlabel="time (s)"
        )
        self.map.plot(0, 0, "^", color=style.BLACK, ms=9, label="sensor", linestyle="none")
        (self.points,) = self.map.plot([], [], "o", ms=4, color=style.BLUE, label="from the recording")
        (self.track,) = self.map.plot([], [], "--", color=style.ORANGE, label="truth")
        self.map.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", xlim=(-60, 60), ylim=(-60, 60))
        self.map.set_title("Angles and depth name a place")
        self.map.legend(loc="lower right")
        self.title = self.panels[0].set_title(" ")
        style.animate(*self.dots, *self.truths, self.points, self.track, self.title)

    def draw(self, result):
        """Show one reading of the recording; return the sentence."""
        names = ("azimuth_deg", "angle_deg")
        for name, dots, truth in zip(names, self.dots, self.truths, strict=True):
            dots.set_data(result["time"], result[name])
            truth.set_data(result["time"], result[f"true_{name}"])
        self.points.set_data(*result["points"].T)
        self.track.set_data(*result["track"].T)
        azimuth, truth = np.radians(result["azimuth_deg"]), np.radians(result["true_azimuth_deg"])
        off = np.degrees(rmse(angle_difference(azimuth, truth)))
        self.title.set_text(f"Azimuth wrong by {_significant(off)}° (RMSE)")
        return (
            f"Read as {result['order']} in windows of {result['window']:.2f} s, the recording gives "
            f"{result['time'].size} directions; their azimuths are wrong by {_significant(off)}° (RMSE)."
        )


def _track_map(axes, track, margin=150):
    axes.plot(*track.T, "--", color=style.ORANGE, label="recorded track")
    axes.plot(*track[:1].T, "v", color=style.BLACK, label="its first fix")
    low, high = track.min(axis=0) - margin, track.max(axis=0) + margin
    axes.set(xlabel="x, east (m)", ylabel="y, north (m)", aspect="equal")
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))


def _significant(degrees):
    return f"{degrees:.1f}" if degrees < 10 else f"{degrees:.0f}"
