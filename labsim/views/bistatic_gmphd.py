"""The pictures of chapter 08: ellipse and ray, echoes and clutter, the mixture step by step, whole scenes."""

import numpy as np

from labsim.views import style

FAR = 1_000.0
CIRCLE = np.stack([np.cos(np.linspace(0, 2 * np.pi, 41)), np.sin(np.linspace(0, 2 * np.pi, 41))])
RADIUS_95 = np.sqrt(5.991)


class GeometryView:
    """The bistatic triangle, with the angles of the page: figure 1 of the paper.

    Draws a dict with receiver, source, target (2,), m; velocity (2,), m/s; bearing, radians; delay, s;
    to_receiver and to_source, the angles between the velocity and the directions to the two, radians.
    """

    def __init__(self):
        self.figure = style.figure(7.0, 3.9)
        self.axes = self.figure.subplots()
        (self.baseline,) = self.axes.plot([], [], color=style.GREY, linestyle=":", label="baseline D")
        (self.ping,) = self.axes.plot([], [], color=style.ORANGE, linestyle="--", label="ping")
        (self.echo,) = self.axes.plot([], [], color=style.BLUE, linestyle="-", label="echo")
        (self.ends,) = self.axes.plot([], [], "^", color=style.BLACK, markersize=8)
        (self.target,) = self.axes.plot([], [], "o", color=style.GREEN, markersize=8)
        look = dict(arrowstyle="->", color=style.BLACK, linewidth=1.5)
        self.arrow = self.axes.annotate("", (1, 1), (0, 0), arrowprops=look)
        self.names = [
            self.axes.annotate(name, (0, 0), shift, textcoords="offset points", ha="center", fontsize=9)
            for name, shift in (
                ("receiver $Z_R$", (0, -15)),
                ("source $Z_S$", (0, -15)),
                ("target $Z$", (-6, 10)),
                ("velocity $v$", (18, 4)),
            )
        ]
        self.arcs, self.angles = [], []
        for name in (r"$\alpha$", r"$\varphi_R$", r"$\varphi_S$"):
            self.arcs += self.axes.plot([], [], color=style.BLACK, linestyle="-", linewidth=1)
            self.angles.append(self.axes.text(0, 0, name, ha="center", va="center"))
        self.axes.set(xlabel="x (km)", ylabel="y (km)", xlim=(-3.2, 5), ylim=(-0.6, 5.4), aspect="equal")
        self.axes.legend(loc="upper right", fontsize=8)
        self.title = self.axes.set_title(" ")
        style.animate(self.baseline, self.ping, self.echo, self.ends, self.target, self.arrow, self.title)
        style.animate(*self.names, *self.arcs, *self.angles)

    def draw(self, result):
        """Draw the triangle; return the sentence."""
        receiver, source, target = (np.divide(result[name], FAR) for name in ("receiver", "source", "target"))
        course = np.arctan2(*result["velocity"][::-1])
        tip = target + 1.7 * _direction(course)
        self.baseline.set_data(*np.transpose([receiver, source]))
        self.ping.set_data(*np.transpose([source, target]))
        self.echo.set_data(*np.transpose([target, receiver]))
        self.ends.set_data(*np.transpose([receiver, source]))
        self.target.set_data(*target[:, None])
        self.arrow.xy, self.arrow.xyann = tip, target
        for name, place in zip(self.names, (receiver, source, target, tip), strict=True):
            name.xy = place
        to_receiver, to_source = (np.arctan2(*(end - target)[::-1]) for end in (receiver, source))
        self._draw_angle(0, receiver, (0.0, result["bearing"]), 0.6, 0.5)
        self._draw_angle(1, target, (to_receiver, course), 1.3, 0.2)
        self._draw_angle(2, target, (to_source, course), 0.55, 0.5)
        bearing_deg = np.degrees(result["bearing"])
        self.title.set_text(f"The echo arrives after {result['delay']:.1f} s, from {bearing_deg:.0f}°")
        angles = np.degrees([result["to_receiver"], result["to_source"]])
        return (
            f"Ping to target to receiver takes {result['delay']:.1f} s, and the echo comes from a bearing of "
            f"{bearing_deg:.0f}°; the target's velocity makes {angles[0]:.0f}° with the "
            f"direction to the receiver and {angles[1]:.0f}° with that to the source."
        )

    def _draw_angle(self, number, centre, ends, radius, place):
        """An arc between two directions, radians, its name at the fraction `place` of it."""
        self.arcs[number].set_data(*centre[:, None] + radius * _direction(np.linspace(*ends, 40)))
        middle = ends[0] + place * (ends[1] - ends[0])
        self.angles[number].set_position(centre + (radius + 0.25) * _direction(middle))


class EllipseView:
    """Bearing and delay on the map, and close up: what errors do to the position, and the linear covariance.

    Draws a dict with receiver, source, target (2,), m; bearing, radians; ellipse (n, 2), m, all places of the
    delay; found (k, 2), positions from noisy measurements, m; covariance (2, 2); cover; impossible, the share
    of draws without a position.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 4.4)
        self.map, self.close = self.figure.subplots(1, 2, width_ratios=(5, 4))
        (self.ellipse,) = self.map.plot([], [], color=style.ORANGE, linestyle="--", label="same delay")
        (self.ray,) = self.map.plot([], [], color=style.BLUE, linestyle="-", label="same bearing")
        (self.ends,) = self.map.plot([], [], "^", color=style.BLACK, markersize=8, label="receiver, source")
        (self.target,) = self.map.plot([], [], "o", color=style.GREEN, markersize=8, label="target")
        self.map.set(xlim=(-10.5, 14.5), ylim=(-12.5, 12.5), aspect="equal", xlabel="x (km)", ylabel="y (km)")
        self.map.legend(loc="upper center", fontsize=8, ncols=4, bbox_to_anchor=(0.5, -0.16), columnspacing=1)
        self.map_title = self.map.set_title(" ")
        (self.cloud,) = self.close.plot([], [], ".", color=style.GREY, markersize=2, label="positions found")
        (self.drawn,) = self.close.plot(
            [], [], color=style.BLUE, linestyle="-", label="95 % of the covariance"
        )
        (self.truth,) = self.close.plot([], [], "o", color=style.GREEN, markersize=8, label="target")
        self.close.set(aspect="equal", xlabel="error in x (km)", ylabel="error in y (km)")
        self._show_up_to(1.0)
        self.close.legend(loc="lower left", fontsize=8)
        self.close_title = self.close.set_title(" ")
        style.animate(self.ellipse, self.ray, self.ends, self.target, self.map_title)
        style.animate(self.cloud, self.drawn, self.truth, self.close_title)

    def draw(self, result):
        """Draw one target; return the sentence."""
        target = result["target"]
        reach = RADIUS_95 * np.sqrt(np.linalg.eigvalsh(result["covariance"])[-1]) / FAR
        self._show_up_to(next((edge for edge in (1.0, 2.0) if edge > 1.3 * reach), 4.0))
        far = result["receiver"] + 3e4 * _direction(result["bearing"])
        self.ellipse.set_data(*result["ellipse"].T / FAR)
        self.ray.set_data(*np.transpose([result["receiver"], far]) / FAR)
        self.ends.set_data(*np.transpose([result["receiver"], result["source"]]) / FAR)
        self.target.set_data(*target[:, None] / FAR)
        self.cloud.set_data(*(result["found"] - target).T / FAR)
        self.drawn.set_data(*_outlines(np.zeros((1, 2)), result["covariance"][None], RADIUS_95) / FAR)
        self.truth.set_data([0], [0])
        self.map_title.set_text(f"Ray and ellipse meet at ({target[0] / FAR:.1f}, {target[1] / FAR:.1f}) km")
        self.close_title.set_text(f"The 95 % region holds {result['cover']:.0%}")
        lost = f"; {result['impossible']:.0%} of the draws have no position" if result["impossible"] else ""
        return (
            f"Of the positions found around ({target[0] / FAR:.1f}, {target[1] / FAR:.1f}) km, the "
            f"linearised covariance's 95 % region holds {result['cover']:.0%}{lost}."
        )

    def _show_up_to(self, reach):
        if self.close.get_xlim()[1] != reach:
            ticks = np.linspace(-reach, reach, 5)
            self.close.set(xlim=(-reach, reach), ylim=(-reach, reach), xticks=ticks, yticks=ticks)


class LoudnessView:
    """The four tracks, and how loud each echo is from scan to scan.

    Draws a dict with states (scans, targets, 4), m and m/s; snr_db (scans, targets); receiver, source, m.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 4.0)
        self.map, self.level = self.figure.subplots(1, 2)
        self.tracks, self.births, self.levels = [], [], []
        for number, (colour, line, marker) in enumerate(style.LINES[:4], 1):
            self.tracks += self.map.plot([], [], color=colour, linestyle=line, label=f"target {number}")
            self.births += self.map.plot([], [], marker, color=colour)
            self.levels += self.level.plot([], [], color=colour, linestyle=line)
        (self.ends,) = self.map.plot([], [], "^", color=style.BLACK, markersize=8)
        self.names = [
            self.map.annotate(name, (0, 0), (0, 7), textcoords="offset points", ha="center")
            for name in ("receiver", "source")
        ]
        self.map.set(xlim=(-6.5, 6.7), ylim=(-0.5, 9), aspect="equal", xlabel="x (km)", ylabel="y (km)")
        self.map.set_title("Four targets come and go")
        self.map.legend(fontsize=8, loc="lower left")
        self.level.set(xlim=(-5, 104), ylim=(-1.25, 26.25), xlabel="scan", ylabel="SNR of the echo (dB)")
        self.level.set_title("The same boat whispers and shouts")
        style.animate(*self.tracks, *self.births, *self.levels, self.ends, *self.names)

    def draw(self, result):
        """Draw tracks and levels; return the sentence."""
        for number, (track, birth, level) in enumerate(
            zip(self.tracks, self.births, self.levels, strict=True)
        ):
            x, _, y, _ = result["states"][:, number].T / FAR
            track.set_data(x, y)
            first = np.flatnonzero(np.isfinite(x))[:1]
            birth.set_data(x[first], y[first])
            level.set_data(np.arange(len(x)), result["snr_db"][:, number])
        ends = np.divide([result["receiver"], result["source"]], FAR)
        self.ends.set_data(*ends.T)
        for name, place in zip(self.names, ends, strict=True):
            name.xy = place
        low, high = np.nanmin(result["snr_db"]), np.nanmax(result["snr_db"])
        return f"Echoes of the four targets range from {low:.0f} to {high:.0f} dB as range and aspect change."


class EchoesView:
    """Detections of one scan on the map, those of the scans before, and the true places.

    Draws a dict with now (n, 2), before (m, 2), truth (k, 2), m; heard, targets detected in this scan.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 4.6)
        self.axes = self.figure.subplots()
        (self.before,) = self.axes.plot([], [], ".", color="#9a9a9a", markersize=3, label="scans before")
        (self.now,) = self.axes.plot([], [], "o", color=style.BLUE, markersize=5, label="this scan")
        (self.truth,) = self.axes.plot(
            [], [], "s", color=style.ORANGE, markersize=13, fillstyle="none", label="true places"
        )
        self.axes.plot([0, 4], [0, 0], "^", color=style.BLACK, markersize=8, label="receiver, source")
        self.axes.set(xlim=(-11, 15), ylim=(-0.7, 12), aspect="equal", xlabel="x (km)", ylabel="y (km)")
        self.axes.legend(loc="upper left", fontsize=8)
        self.title = self.axes.set_title(" ")
        style.animate(self.before, self.now, self.truth, self.title)

    def draw(self, result):
        """Draw one scan; return the sentence."""
        for line, points in ((self.before, "before"), (self.now, "now"), (self.truth, "truth")):
            line.set_data(*result[points].T / FAR)
        detections, heard = len(result["now"]), result["heard"]
        self.title.set_text(f"{detections} detections in this scan: {heard} of them are targets")
        return (
            f"This scan has {detections} detections; {heard} are echoes of targets and "
            f"{detections - heard} are clutter."
        )


class StepView:
    """The mixture at one stage of a step: close up around one target, and the weights of all components.

    Draws a dict with mean (J, 2), covariance (J, 2, 2), weight (J,), measured (M, 2), centre (2,), m; stage;
    number, the true number of targets. The thresholds do not change: the weight above which a component is
    reported, and that below which it is pruned, are given once.
    """

    def __init__(self, above, below):
        self.above, light = above, above / 50
        self.classes = ((above, np.inf), (light, above), (0.0, light))
        names = (f"weight > {above:g}", f"{light:g} to {above:g}", f"below {light:g}")
        self.figure = style.figure(9.2, 4.5)
        self.map, self.stems = self.figure.subplots(1, 2)
        looks = ((style.BLUE, "-", 2.2), (style.ORANGE, "--", 1.4), (style.GREY, ":", 1.0))
        self.outlines = [
            self.map.plot([], [], color=colour, linestyle=line, linewidth=width, label=name)[0]
            for name, (colour, line, width) in zip(names, looks, strict=True)
        ]
        (self.measured,) = self.map.plot([], [], "+", color=style.GREEN, markersize=12, label="detection")
        self.map.plot(0, 0, "*", color=style.BLACK, markersize=11, label="true place")
        self.map.set(xlim=(-0.5, 0.5), ylim=(-0.5, 0.5), aspect="equal")
        self.map.set(xlabel="x from the true place (km)", ylabel="y from the true place (km)")
        self.map.legend(loc="upper left", fontsize=8)
        (self.weights,) = self.stems.plot([], [], "o", color=style.BLUE, markersize=4, label="component")
        self.stems.axhline(above, color=style.BLACK, linestyle="--", label="reported above")
        self.stems.axhline(below, color=style.PINK, linestyle=":", label="pruned below")
        self.stems.set(yscale="log", xlim=(-1, 61), ylim=(1e-11, 5))
        self.stems.set_xlabel("component, heaviest first")
        self.stems.set_ylabel("weight (expected targets)")
        self.stems.legend(loc="lower left", fontsize=8)
        self.map_title, self.stem_title = self.map.set_title(" "), self.stems.set_title(" ")
        style.animate(*self.outlines, self.measured, self.weights, self.map_title, self.stem_title)

    def draw(self, result):
        """Draw one stage; return the sentence."""
        weight, offset = result["weight"], result["mean"] - result["centre"]
        near = np.all(np.abs(offset) < 4_000, axis=1)
        for (low, high), outline in zip(self.classes, self.outlines, strict=True):
            chosen = near & (weight > low) & (weight <= high)
            outline.set_data(*_outlines(offset[chosen], result["covariance"][chosen], 2.0) / FAR)
        self.measured.set_data(*(result["measured"] - result["centre"]).T / FAR)
        self.weights.set_data(np.arange(weight.size), np.sort(weight)[::-1])
        total, heavy = weight.sum(), np.count_nonzero(weight > self.above)
        self.map_title.set_text(f"{result['stage'].capitalize()}: 2σ outlines")
        self.stem_title.set_text(f"{weight.size} components, total weight {total:.2f}")
        moment = "Before the step" if result["stage"] == "before" else f"After '{result['stage']}'"
        return (
            f"{moment} the mixture has {weight.size} components of total weight "
            f"{total:.2f}, {heavy} of them above {self.above:g}; {result['number']} targets are there."
        )


class SceneView:
    """A whole scene: reports on the map, number of targets, and OSPA from scan to scan.

    Draws a dict with reported (n, 2), m; number and count (scans,), true and reported; weight_sum (scans,);
    ospa (scans, 3): distance, location and cardinality, m; name, the method. The tracks do not change:
    `states` (scans, targets, 4) is given once.
    """

    def __init__(self, states):
        self.figure = style.figure(9.6, 4.8)
        grid = self.figure.add_gridspec(2, 2, width_ratios=(1, 1))
        self.map = self.figure.add_subplot(grid[:, 0])
        self.number = self.figure.add_subplot(grid[0, 1])
        self.error = self.figure.add_subplot(grid[1, 1], sharex=self.number)
        scans = len(states)
        x, y = states[..., 0] / FAR, states[..., 2] / FAR
        for k, column in enumerate(zip(x.T, y.T, strict=True)):
            label = "true tracks" if k == 0 else None
            self.map.plot(*column, color=style.ORANGE, linestyle="-", linewidth=4, alpha=0.4, label=label)
        (self.points,) = self.map.plot([], [], ".", color=style.BLUE, markersize=4, label="reported")
        self.map.set(xlim=(-8.5, 12.5), ylim=(-0.5, 10), xlabel="x (km)", ylabel="y (km)", aspect="equal")
        self.map.legend(loc="lower left", fontsize=8)
        true = np.isfinite(x).sum(axis=1)
        self.number.step(range(scans), true, where="mid", color=style.BLACK, linestyle="-", label="true")
        (self.sum,) = self.number.plot([], [], color=style.ORANGE, linestyle="--", label="weight sum")
        (self.count,) = self.number.plot([], [], "o", color=style.BLUE, markersize=3, label="reported")
        self.number.set(xlim=(-1, scans), ylim=(-0.5, 11), ylabel="targets")
        self.number.legend(loc="upper right", fontsize=8, ncols=3)
        (self.ospa,) = self.error.plot([], [], color=style.BLUE, linestyle="-", label="OSPA")
        (self.location,) = self.error.plot([], [], color=style.GREEN, linestyle="-.", label="location part")
        self.error.set(ylim=(0, 680), yticks=range(0, 501, 100), xlabel="scan", ylabel="OSPA (m)")
        self.error.legend(loc="upper right", fontsize=8, ncols=2)
        self.map_title, self.error_title = self.map.set_title(" "), self.error.set_title(" ")
        self.number_title = self.number.set_title(" ")
        style.animate(self.points, self.sum, self.count, self.ospa, self.location)
        style.animate(self.map_title, self.number_title, self.error_title)

    def draw(self, result):
        """Draw one run; return the sentence."""
        scans = np.arange(len(result["count"]))
        distance, location, cardinality = result["ospa"].mean(axis=0)
        wrong = np.mean(result["count"] != result["number"])
        self.points.set_data(*result["reported"].T / FAR)
        self.sum.set_data(scans, result["weight_sum"])
        self.count.set_data(scans, result["count"])
        self.ospa.set_data(scans, result["ospa"][:, 0])
        self.location.set_data(scans, result["ospa"][:, 1])
        self.map_title.set_text(result["name"])
        self.number_title.set_text(f"The number is wrong in {wrong:.0%} of the scans")
        self.error_title.set_text(f"Mean OSPA {distance:.0f} m")
        return (
            f"{result['name']}: mean OSPA {distance:.0f} m (location {location:.0f} m, cardinality "
            f"{cardinality:.0f} m); the number of targets is wrong in {wrong:.0%} of the scans."
        )


class ComparisonView:
    """OSPA and the number reported, scan by scan, averaged over runs, for several methods.

    Draws a dict with ospa and count, dicts from method to (scans,); number (scans,).
    """

    def __init__(self):
        self.figure = style.figure(9.2, 5.0)
        self.error, self.number = self.figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        self.error.set(ylabel="mean OSPA (m)")
        self.number.set(xlabel="scan", ylabel="mean number reported")

    def draw(self, result):
        """Draw the curves; return the sentence."""
        self.number.step(
            np.arange(len(result["number"])), result["number"], where="mid", color=style.GREY, linestyle="-",
            linewidth=5, alpha=0.4, label="true",
        )  # fmt: skip
        for method, (colour, line, _) in zip(result["ospa"], style.LINES, strict=False):
            self.error.plot(result["ospa"][method], color=colour, linestyle=line, label=method)
            self.number.plot(result["count"][method], color=colour, linestyle=line)
        self.error.set_ylim(0, None)
        self.error.legend(fontsize=8, ncols=2)
        self.number.legend(fontsize=8)
        means = sorted((ospa.mean(), method) for method, ospa in result["ospa"].items())
        self.error.set_title(f"Least on average: {means[0][1]}; most: {means[-1][1]}")
        return "Mean OSPA over all scans: " + ", ".join(f"{m} {value:.0f} m" for value, m in means) + "."


class CostView:
    """CPU time of the parts of a step against the number of components, on the machine that draws it.

    Draws a dict with components (n,), and times, a dict from part to (n,), s.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 3.8)
        self.axes = self.figure.subplots()
        self.axes.set(xscale="log", yscale="log", xlabel="components", ylabel="CPU time (ms)")

    def draw(self, result):
        """Draw the curves; return the sentence."""
        for (part, times), (colour, line, marker) in zip(result["times"].items(), style.LINES, strict=False):
            self.axes.plot(
                result["components"], 1e3 * times, color=colour, linestyle=line, marker=marker, label=part
            )
        self.axes.set_xticks(result["components"], result["components"])
        self.axes.minorticks_off()
        self.axes.legend(fontsize=8)
        largest = max(result["times"], key=lambda part: result["times"][part][-1])
        self.axes.set_title(f"On this machine, in this run: {largest} costs most in the end")
        return (
            f"On the machine that drew this, with {result['components'][-1]} components, the most expensive "
            f"part was {largest}."
        )


def _direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def _outlines(centre, covariance, radius):
    """Outlines of Gaussians as one line with gaps: (2, k)."""
    if len(centre) == 0:
        return np.zeros((2, 0))
    curves = centre[:, :, None] + radius * np.linalg.cholesky(covariance) @ CIRCLE
    gap = np.full((len(centre), 2, 1), np.nan)
    return np.concatenate([curves, gap], axis=2).swapaxes(0, 1).reshape(2, -1)
