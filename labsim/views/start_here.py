"""The picture of the start notebook: a vessel passes a sensor, seen from above."""

import numpy as np

from labsim.views import style


class PassingView:
    """A map with the vessel's track, and the distance to the sensor against time.

    Draws a dict with `time` (n,), s; `position` (n, 2), m; `distance` (n,), m; and `now`, an index into them.
    """

    def __init__(self, result):
        self.figure = style.figure(9, 3.8)
        self.map, self.curve = self.figure.subplots(1, 2, width_ratios=(3, 2))
        x, y = result["position"].T
        self.map.plot(x, y, color=style.GREY, linestyle=":", label="track")
        self.map.plot(0, 0, "^", color=style.BLACK, markersize=10, label="sensor")
        (self.ray,) = self.map.plot([], [], color=style.ORANGE, linestyle="--", label="line of sight")
        (self.vessel,) = self.map.plot([], [], "o", color=style.BLUE, markersize=10, label="vessel")
        self.map.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", xlim=(-320, 520), ylim=(-150, 300))
        self.map.legend(loc="lower right", ncols=2)
        self.map_title = self.map.set_title("A vessel passes")
        self.curve.plot(result["time"], result["distance"], color=style.GREY, linestyle=":")
        (self.dot,) = self.curve.plot([], [], "o", color=style.BLUE, markersize=10)
        self.curve.set(xlabel="time (s)", ylabel="distance to the sensor (m)", ylim=(0, None))
        self.curve.set_title("Near once, far twice")
        style.animate(self.ray, self.vessel, self.dot, self.map_title)

    def draw(self, result):
        """Move the vessel to `now`; return the sentence."""
        now = result["now"]
        x, y = result["position"][now]
        distance, time = result["distance"][now], result["time"][now]
        bearing = np.degrees(np.arctan2(y, x))
        self.ray.set_data([0, x], [0, y])
        self.vessel.set_data([x], [y])
        self.dot.set_data([time], [distance])
        self.map_title.set_text(f"Bearing {bearing:.0f}°, distance {distance:.0f} m")
        where = f"{distance:.0f} m from the sensor, at a bearing of {bearing:.0f}°"
        return f"After {time:.2f} s the vessel is {where}."
