"""The pictures of chapter 07: gates on the map and over time, coverage, and pairing rules at work."""

import numpy as np

from labsim.bearing_gate import FALSE_ALARM
from labsim.views import style

FAR = 1_000.0
SOURCE_NAMES = ("torpedo 1", "torpedo 2", "boat 3", "boat 4")


class GateView:
    """A gate on the map, and the same gate as offsets from the bearing of array 1 against range.

    Draws a dict with theta, error, own (the parallax of the target), lower and upper (the gate minus theta),
    radians; baseline, low, up and target_range, m; ranges (n,) and parallaxes (n,) of the curve.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 4.6)
        self.map, self.offsets = self.figure.subplots(1, 2, width_ratios=(5, 4))
        (self.place,) = self.map.fill([0, 0, 0], [0, 0, 0], color="#c9dcea", label="possible places")
        (self.bearing,) = self.map.plot([], [], color=style.BLUE, label="bearing at array 1")
        (self.edges,) = self.map.plot([], [], color=style.ORANGE, linestyle="--", label="gate of array 2")
        (self.arrays,) = self.map.plot([], [], "^-", color=style.BLACK, markersize=7, label="arrays 1 and 2")
        (self.target,) = self.map.plot([], [], "o", color=style.GREEN, markersize=8, label="target")
        self.map.set(xlim=(-15, 15), ylim=(-13, 13), aspect="equal")
        self.map.set(xlabel="across the baseline (km)", ylabel="along the baseline (km)")
        self.map.legend(loc="lower left", fontsize=8)
        self.map_title = self.map.set_title(" ")
        (self.curve,) = self.offsets.plot([], [], color=style.BLACK, linestyle=":", label="parallax")
        (self.gate,) = self.offsets.plot([], [], color=style.ORANGE, linestyle="--", label="gate of array 2")
        (self.bounds,) = self.offsets.plot([], [], color=style.PINK, linestyle="-.", label="range bounds")
        (self.dot,) = self.offsets.plot([], [], "o", color=style.GREEN, markersize=8, label="target")
        self.offsets.axvline(0, color=style.BLUE, label="array 1")
        self.offsets.set(xlim=(-48, 48), ylim=(0, 15), ylabel="range (km)")
        self.offsets.set_xlabel("bearing at array 2 minus bearing at array 1 (°)")
        self.offsets.legend(loc="upper left", fontsize=8)
        self.offsets_title = self.offsets.set_title(" ")
        style.animate(self.place, self.bearing, self.edges, self.arrays, self.target, self.map_title)
        style.animate(self.curve, self.gate, self.bounds, self.dot, self.offsets_title)

    def draw(self, result):
        """Draw one gate; return the sentence."""
        self._draw_map(result)
        left, right, own = np.degrees([result["lower"], result["upper"], result["own"]])
        inside = left <= own <= right
        self.curve.set_data(np.degrees(result["parallaxes"]), result["ranges"] / FAR)
        self.gate.set_data([left, left, np.nan, right, right], [0, 15, np.nan, 0, 15])
        low, up = result["low"] / FAR, min(result["up"] / FAR, 99)
        self.bounds.set_data([-48, 48, np.nan, -48, 48], [low, low, np.nan, up, up])
        self.dot.set_data([own], [result["target_range"] / FAR])
        edges = f"{_side(left)} to {_side(right)}"
        self.map_title.set_text(f"Gate: {edges}")
        self.offsets_title.set_text("The target is inside" if inside else "The target is outside")
        return (
            f"The gate of array 2 runs from {edges} of the bearing at array 1; the target, "
            f"{result['target_range'] / FAR:.1f} km away, is seen {_side(own)} from it, "
            f"{'inside' if inside else 'outside'} the gate."
        )

    def _draw_map(self, result):
        theta, low, up = result["theta"], result["low"] / FAR, min(result["up"] / FAR, 40)
        angle = theta + result["error"] * np.linspace(-1, 1, 9)
        outline = np.concatenate([_point(angle, low), _point(angle[::-1], up)])
        second = np.array([0, result["baseline"] / FAR])
        gate = [second + _point(theta + result[edge], 40) for edge in ("lower", "upper")]
        self.place.set_xy(outline)
        self.bearing.set_data(*np.transpose([(0, 0), _point(theta, 40)]))
        self.edges.set_data(*np.transpose([gate[0], second, gate[1]]))
        self.arrays.set_data([0, 0], [0, second[1]])
        self.target.set_data(*_point(theta, result["target_range"] / FAR)[:, None])


class GateSizeView:
    """Size of the gate against bearing, minimum range and baseline: figures 2 to 4 of the paper.

    Draws a dict with theta, size_by_theta; low, size_by_low (4, n); baseline, size_by_baseline (4, n);
    labels of the four; largest and where. Angles in radians, lengths in m.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 3.7)
        self.axes = self.figure.subplots(1, 3, sharey=True)
        titles = (
            "Widest just short of abeam",
            "A longer reach, a smaller gate",
            "Almost linear in the baseline",
        )
        labels = ("baseline bearing θ (°)", "minimum range (km)", "baseline (km)")
        for axes, title, label in zip(self.axes, titles, labels, strict=True):
            axes.set_title(title, fontsize=10)
            axes.set_xlabel(label)
        self.axes[0].set_ylabel("size of the gate (°)")

    def draw(self, result):
        """Draw the three panels; return the sentence."""
        by_theta, by_low, by_baseline = self.axes
        size, where = np.degrees([result["largest"], result["where"]])
        for half in np.split(np.degrees([result["theta"], result["size_by_theta"]]), 2, axis=1):
            by_theta.plot(*half, color=style.BLUE, linestyle="-")
        by_theta.plot([-where, where], [size, size], "o", color=style.ORANGE)
        by_theta.annotate(f"{size:.2f}° at ±{where:.1f}°", (0, size), ha="center", va="bottom", fontsize=9)
        for panel, horizontal, sizes in (
            (by_low, result["low"], result["size_by_low"]),
            (by_baseline, result["baseline"], result["size_by_baseline"]),
        ):
            for row, label, (colour, line, _) in zip(sizes, result["labels"], style.LINES, strict=False):
                panel.plot(horizontal / FAR, np.degrees(row), color=colour, linestyle=line, label=label)
        by_baseline.legend(title="θ", fontsize=8)
        return (
            f"The gate is widest, {size:.2f}°, at θ = ±{where:.1f}°; it shrinks as the minimum range grows "
            "and grows almost linearly with the baseline."
        )


class SceneView:
    """The attack: figure 5, tracks on a map, and figure 6, the bearings that array 1 reports.

    Draws a dict with tracks (sources, n, 2) and own (n, 2), east and north, m; time (n,), s;
    bearing (n, sources), radians.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 4.0)
        self.map, self.record = self.figure.subplots(1, 2, width_ratios=(1, 1))
        self.tracks, self.starts, self.bearings = [], [], []
        for name, (colour, line, marker) in zip(SOURCE_NAMES, style.LINES, strict=False):
            self.tracks += self.map.plot([], [], color=colour, linestyle=line, label=name)
            self.starts += self.map.plot([], [], marker, color=colour)
            self.bearings += self.record.plot([], [], marker, color=colour, markersize=3, label=name)
        (self.own,) = self.map.plot([], [], color=style.BLACK, label="own vessel")
        (self.own_start,) = self.map.plot([], [], "^", color=style.BLACK)
        self.map.set(xlim=(-1, 16), ylim=(-8.5, 5.5), aspect="equal")
        self.map.set(xlabel="east (km)", ylabel="north (km)")
        self.map.set_title("Two torpedoes come, two boats leave")
        self.map.legend(fontsize=8, loc="lower left")
        self.record.set(xlim=(-18, 378), ylim=(10, 165), xlabel="time (s)", ylabel="bearing at array 1 (°)")
        self.record.set_title("Four bearings, three degrees of noise")
        self.record.legend(fontsize=8, markerscale=2, loc="lower left")
        style.animate(*self.tracks, *self.starts, *self.bearings, self.own, self.own_start)

    def draw(self, result):
        """Draw tracks and bearings; return the sentence."""
        tracks, starts = [*self.tracks, self.own], [*self.starts, self.own_start]
        for track, start, places in zip(tracks, starts, [*result["tracks"], result["own"]], strict=True):
            track.set_data(*places.T / FAR)
            start.set_data(*places[:1].T / FAR)
        for line, bearing in zip(self.bearings, np.degrees(result["bearing"]).T, strict=True):
            line.set_data(result["time"], bearing)
        low, high = np.degrees([np.nanmin(result["bearing"]), np.nanmax(result["bearing"])])
        return (
            f"For {result['time'][-1]:.0f} s array 1 reports four noisy bearings between {low:.0f}° and "
            f"{high:.0f}°; those of the torpedoes turn north as they close in."
        )


class GateTimeView:
    """The gate of one source over time, over all bearings of array 2: figures 7 and 8 of the paper.

    Draws a dict with time (n,), s; second (n, sources), lower and upper (n,), radians; source, index.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 4.2)
        self.axes = self.figure.subplots()
        (self.others,) = self.axes.plot([], [], ".", color=style.GREY, markersize=3, label="other bearings")
        (self.upper,) = self.axes.plot([], [], color=style.ORANGE, linestyle="--", label="gate")
        (self.lower,) = self.axes.plot([], [], color=style.ORANGE, linestyle="--")
        (self.caught,) = self.axes.plot(
            [], [], "o", color=style.BLUE, markersize=4, label="own bearing, inside"
        )
        (self.lost,) = self.axes.plot(
            [], [], "X", color=style.BLACK, markersize=6, label="own bearing, outside"
        )
        self.axes.set(xlim=(-4, 364), ylim=(-20, 190), xlabel="time (s)", ylabel="bearing at array 2 (°)")
        self.axes.legend(loc="lower left", ncols=2, fontsize=8)
        self.title = self.axes.set_title(" ")
        style.animate(self.others, self.upper, self.lower, self.caught, self.lost, self.title)

    def draw(self, result):
        """Draw one source's gate; return the sentence."""
        time, second, source = result["time"], np.degrees(result["second"]), result["source"]
        lower, upper, own = np.degrees(result["lower"]), np.degrees(result["upper"]), second[:, source]
        inside = (lower <= own) & (own <= upper)
        others = np.delete(second, source, axis=1)
        self.others.set_data(np.repeat(time, others.shape[1]), others.ravel())
        self.lower.set_data(time, lower)
        self.upper.set_data(time, upper)
        self.caught.set_data(time[inside], own[inside])
        self.lost.set_data(time[~inside], own[~inside])
        early, late = inside[time < 100].mean(), inside[time >= 200].mean()
        name = SOURCE_NAMES[source]
        self.title.set_text(
            f"{name.capitalize()}: {early:.0%} inside in the first 100 s, {late:.0%} after 200 s"
        )
        return (
            f"The gate of {name} holds its own bearing at array 2 in {early:.0%} of the scans before 100 s "
            f"and in {late:.0%} of those after 200 s."
        )


class TwoGatesView:
    """Both torpedoes' gates over time, the minimum-range gate above (figure 7), the range-bounded below (8).

    Draws a dict with time (n,), s; second (n, sources), radians; gates, a dict from kind to (lower, upper),
    each (n, sources), radians.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 6.4)
        self.axes = self.figure.subplots(2, 1, sharex=True)
        self.lines = [self._lines(axes) for axes in self.axes]
        self.titles = [axes.set_title(" ") for axes in self.axes]
        self.axes[1].set_xlabel("time (s)")
        self.axes[0].legend(loc="lower left", ncols=3, fontsize=8)
        style.animate(*self.titles, *(line for lines in self.lines for line in lines))

    @staticmethod
    def _lines(axes):
        """The empty lines of one panel: boats, gate and bearings of either torpedo, bearings outside."""
        lines = axes.plot([], [], ".", color=style.GREY, markersize=3, label="boats")
        for name, (colour, line, marker) in zip(SOURCE_NAMES[:2], style.LINES, strict=False):
            lines += axes.plot([], [], color=colour, linestyle=line, linewidth=1, label=f"gate of {name}")
            lines += axes.plot([], [], marker, color=colour, markersize=3, label=name)
        lines += axes.plot([], [], "x", color=style.BLACK, markersize=6, label="outside its gate")
        axes.set(xlim=(-4, 364), ylim=(-20, 170), ylabel="bearing at array 2 (°)")
        return lines

    def draw(self, result):
        """Draw the gates; return the sentence."""
        time, second, said = result["time"], np.degrees(result["second"]), []
        for lines, title, (kind, gate) in zip(self.lines, self.titles, result["gates"].items(), strict=True):
            boats, *torpedoes, outside = lines
            boats.set_data(np.repeat(time, 2), second[:, 2:].ravel())
            lower, upper = np.degrees(gate)[..., :2]
            lost = (second[:, :2] < lower) | (second[:, :2] > upper)
            for k in (0, 1):
                edges = np.concatenate([lower[:, k], [np.nan], upper[:, k]])
                torpedoes[2 * k].set_data(np.concatenate([time, [np.nan], time]), edges)
                torpedoes[2 * k + 1].set_data(time, second[:, k])
            outside.set_data(np.repeat(time, 2)[lost.ravel()], second[:, :2][lost])
            first, other = 1 - lost[time >= 200].mean(axis=0)
            shares = f"{first:.0%} and {other:.0%}"
            title.set_text(f"{kind.capitalize()}: after 200 s the gates hold {shares} of their bearings")
            said.append(f"{shares} with the gate from {kind}")
        return f"Own bearings of torpedo 1 and torpedo 2 inside their gates after 200 s: {'; '.join(said)}."


class CoverageView:
    """Where the own bearing falls, against the gate, and the probability that the gate holds it.

    Draws a dict with offsets (n,), density (n,), radians; lower, upper, radians; coverage; ranges (m,), m;
    coverages (m,); both_within; target_range and low, m; bounds, in sigmas.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 4.0)
        self.bell, self.reach = self.figure.subplots(1, 2)
        (self.density,) = self.bell.plot([], [], color=style.BLUE, label="own bearing at array 2")
        (self.gate,) = self.bell.plot([], [], color=style.ORANGE, linestyle="--", label="gate")
        self.bell.set(xlim=(-25, 45), ylim=(0, 0.13), ylabel="probability density (1/°)")
        self.bell.set_xlabel("bearing at array 2 minus bearing at array 1 (°)")
        self.bell.legend(loc="upper right", fontsize=8)
        (self.curve,) = self.reach.plot([], [], color=style.BLUE, label="own bearing in the gate")
        (self.premise,) = self.reach.plot(
            [], [], color=style.BLACK, linestyle=":", label="both errors within bounds"
        )
        (self.limit,) = self.reach.plot([], [], color=style.PINK, linestyle="-.", label="minimum range")
        (self.dot,) = self.reach.plot([], [], "o", color=style.GREEN, markersize=8, label="this target")
        self.reach.set(xlim=(0, 15), ylim=(0, 1.03), xlabel="true range (km)", ylabel="probability")
        self.reach.legend(loc="lower right", fontsize=8)
        self.bell_title, self.reach_title = self.bell.set_title(" "), self.reach.set_title(" ")
        style.animate(self.density, self.gate, self.curve, self.premise, self.limit, self.dot)
        style.animate(self.bell_title, self.reach_title)

    def draw(self, result):
        """Draw the bell and the curve; return the sentence."""
        left, right = np.degrees([result["lower"], result["upper"]])
        self.density.set_data(np.degrees(result["offsets"]), np.radians(result["density"]))
        self.gate.set_data([left, left, np.nan, right, right], [0, 0.1, np.nan, 0, 0.1])
        self.curve.set_data(result["ranges"] / FAR, result["coverages"])
        self.premise.set_data([0, 15], [result["both_within"]] * 2)
        self.limit.set_data([result["low"] / FAR] * 2, [0, 2])
        self.dot.set_data([result["target_range"] / FAR], [result["coverage"]])
        self.bell_title.set_text(f"{result['coverage']:.0%} of the bell lies in the gate")
        self.reach_title.set_text(f"Both errors within {result['bounds']:g}σ: {result['both_within']:.0%}")
        return (
            f"A target {result['target_range'] / FAR:.1f} km away has its own bearing in the gate of "
            f"{result['bounds']:g}-sigma bounds with probability {result['coverage']:.2f}; both errors are "
            f"within those bounds with probability {result['both_within']:.2f}."
        )


class PairingView:
    """One scan: bearings of array 1 above, of array 2 below, gates between, and a rule's pairs as lines.

    Draws a dict with first (n,), second (m,), lower and upper (n,), radians; first_source, second_source;
    partner (n,); rates, the outcome of this scan.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 4.2)
        self.axes = self.figure.subplots()
        self.axes.set(xlim=(-15, 195), ylim=(-0.25, 1.2), xlabel="bearing (°)", yticks=(0, 1))
        self.axes.set_yticklabels(("array 2", "array 1"))
        self.axes.grid(axis="y", visible=False)
        self.points = []
        for name, (colour, _, marker) in zip((*SOURCE_NAMES, "false alarm"), style.LINES, strict=True):
            (points,) = self.axes.plot([], [], marker, color=colour, markersize=8, label=name)
            self.points.append(points)
        (self.gates,) = self.axes.plot([], [], color=style.GREY, linewidth=3, alpha=0.45, label="gates")
        (self.right,) = self.axes.plot([], [], color=style.BLUE, linestyle="-", label="right pair")
        (self.drops,) = self.axes.plot([], [], color=style.GREY, linestyle=":", linewidth=1)
        (self.wrong,) = self.axes.plot([], [], color=style.ORANGE, linestyle="--", label="wrong pair")
        self.axes.legend(loc="upper left", ncols=4, fontsize=8)
        self.title = self.axes.set_title(" ")
        style.animate(*self.points, self.drops, self.gates, self.right, self.wrong, self.title)

    def draw(self, result):
        """Draw one scan; return the sentence."""
        first, second = np.degrees(result["first"]), np.degrees(result["second"])
        for source, points in zip((0, 1, 2, 3, FALSE_ALARM), self.points, strict=True):
            one, other = first[result["first_source"] == source], second[result["second_source"] == source]
            points.set_data(np.concatenate([one, other]), np.repeat([1.0, 0.0], [one.size, other.size]))
        heights = 0.15 + 0.7 * (np.arange(first.size) + 0.5) / max(first.size, 1)
        lower, upper = np.degrees(result["lower"]), np.degrees(result["upper"])
        self.gates.set_data(*_segments(lower, heights, upper, heights))
        self.drops.set_data(*_segments(first, heights, first, np.ones(first.size)))
        paired = np.flatnonzero((result["partner"] >= 0) & np.isfinite(first))
        partner = result["partner"][paired]
        right = (result["first_source"][paired] == result["second_source"][partner]) & (
            result["first_source"][paired] >= 0
        )
        for lines, chosen in ((self.right, right), (self.wrong, ~right)):
            count = np.count_nonzero(chosen)
            ends = first[paired[chosen]], np.ones(count), second[partner[chosen]], np.zeros(count)
            lines.set_data(*_segments(*ends))
        heard = np.count_nonzero(result["first_source"] >= 0)
        correct = int(round(result["rates"]["correct"] * heard))
        wrong = np.count_nonzero(~right)
        pairs = "1 wrong pair" if wrong == 1 else f"{wrong} wrong pairs"
        self.title.set_text(f"{correct} of {heard} sources paired with themselves, {pairs}")
        sources = "1 source" if heard == 1 else f"{heard} sources"
        return f"Of {sources} that array 1 heard, {correct} found their own bearing; the rule makes {pairs}."


class RulesView:
    """Outcome of pairing rules as stacked bars, one panel for each condition.

    Draws a dict of conditions, each a dict of rules, each a dict of rates from `pairing_rates`.
    """

    PARTS = (
        ("correct", style.BLUE, ""),
        ("null", "#9bbfd8", ".."),
        ("ambiguous", "#e6e6e6", ""),
        ("missed", style.PINK, "//"),
        ("false", style.ORANGE, "xx"),
    )

    def __init__(self, conditions, rules):
        self.figure = style.figure(9.6, 4.4)
        self.axes = self.figure.subplots(1, len(conditions), sharey=True)
        for axes, condition in zip(self.axes, conditions, strict=True):
            axes.set_title(condition, fontsize=9)
            axes.set(xlim=(0, 1), xticks=(0, 0.5, 1), xlabel="share of sources")
            axes.grid(axis="y", visible=False)
        self.axes[0].set_yticks(range(len(rules)), rules)
        self.axes[0].invert_yaxis()

    def draw(self, result):
        """Draw the bars; return the sentence."""
        for axes, rules in zip(self.axes, result.values(), strict=True):
            left = np.zeros(len(rules))
            for part, colour, hatch in self.PARTS:
                share = np.array([rates[part] for rates in rules.values()])
                axes.barh(
                    range(len(rules)),
                    share,
                    left=left,
                    color=colour,
                    hatch=hatch,
                    edgecolor="white",
                    label=part,
                )
                left += share
            for row, share in enumerate(rates["correct"] for rates in rules.values()):
                narrow = share < 0.25
                place, colour = (share + 0.05, "black") if narrow else (0.03, "white")
                axes.text(place, row, f"{share:.2f}", color=colour, va="center", fontsize=9)
        handles, labels = self.axes[0].get_legend_handles_labels()
        self.figure.legend(handles, labels, loc="outside lower center", ncols=5, fontsize=8)
        best = [max(rules, key=lambda rule: rules[rule]["correct"]) for rules in result.values()]
        names = (name.replace("\n", ", ") for name in result)
        said = "; ".join(f"{rule} ({name})" for name, rule in zip(names, best, strict=True))
        return f"The rule with the most right pairs: {said}."


class TracksView:
    """Pairing whole tracks: right pairs against time for several lengths, and the bearings that cross.

    Draws a dict with time (n,), second (n, sources), radians; starts and correct, lists of (k,) arrays, one
    for each of labels; crossing, the times at which two bearings cross at array 2 and at array 1, s.
    """

    def __init__(self):
        self.figure = style.figure(9.2, 4.6)
        self.share, self.record = self.figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        self.share.set(ylim=(0.5, 1.02), ylabel="right pairs")
        self.record.set(xlabel="time (s)", ylabel="array 2 (°)")
        self.share.set_title("Patience cures noise, not a crossing")
        self.record.set_title("True bearings at array 2", fontsize=10)

    def draw(self, result):
        """Draw the curves; return the sentence."""
        for label, starts, correct, (colour, line, marker) in zip(
            result["labels"], result["starts"], result["correct"], style.LINES, strict=False
        ):
            self.share.plot(
                starts, correct, color=colour, linestyle=line, marker=marker, markersize=4, label=label
            )
        for name, bearing, (colour, line, _) in zip(
            SOURCE_NAMES, result["second"].T, style.LINES, strict=False
        ):
            self.record.plot(result["time"], np.degrees(bearing), color=colour, linestyle=line, label=name)
        for axes in (self.share, self.record):
            axes.axvspan(*result["crossing"], color="#e6e6e6", zorder=0, label="order differs")
        self.share.legend(fontsize=8, loc="lower left")
        self.record.legend(fontsize=8, ncols=2, loc="lower left")
        blind, ranged = result["correct"][-2:]
        begin, end = result["crossing"]
        return (
            f"Between {begin:.0f} and {end:.0f} s two sources have another order at array 2 than at array 1: "
            f"pairing tracks of 10 scans by bearing alone falls to {blind.min():.0%} right, and to "
            f"{ranged.min():.0%} where the ranges are known to half."
        )


def _point(angle, length):
    return length * np.stack([np.sin(angle), np.cos(angle)], axis=-1)


def _side(degrees):
    """An offset in words: "6.0° counter-clockwise"."""
    size = round(abs(float(degrees)), 1)
    return (
        f"{size:.1f}°" if size == 0 else f"{size:.1f}° {'clockwise' if degrees > 0 else 'counter-clockwise'}"
    )


def _segments(x0, y0, x1, y1):
    gap = np.full(np.shape(x0), np.nan)
    return np.stack([x0, x1, gap], -1).ravel(), np.stack([y0, y1, gap], -1).ravel()
