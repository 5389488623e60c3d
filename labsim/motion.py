"""Tracks of moving vessels, simulated or recorded, and the time at which a sound left them.

A track gives a horizontal position for every time. What a sensor hears at time t left the vessel
earlier, at the retarded time, and comes from where the vessel was then.
"""

import csv
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline, PPoly

from labsim.arguments import require_finite, require_not_negative, require_positive, require_shape

EARTH_RADIUS = 6_371_008.8
COLUMNS = {"time", "x", "y", "latitude", "longitude"}
OTHER_NAMES = {"lat": "latitude", "lon": "longitude", "timestamp": "time", "basedatetime": "time"}


@dataclass(frozen=True)
class Track:
    """A horizontal path in time: `path` is a piecewise polynomial with two components, metres.

    It is defined from `start_time` to `end_time`, seconds; make one with `straight_track`,
    `speed_profile_track`, `course_track`, `waypoint_track` or `load_track`.
    """

    path: PPoly
    start_time: float
    end_time: float

    def position(self, time):
        """Position at times (...), s; returns (..., 2), m. Before and after the track it runs straight on."""
        inside = np.clip(time, self.start_time, self.end_time)
        position, beyond = self.path(inside), np.asarray(time) - inside
        return position + beyond[..., None] * self.path(inside, 1) if np.any(beyond) else position

    def velocity(self, time):
        """Velocity at times (...), s; returns (..., 2), m/s."""
        return self.path(np.clip(time, self.start_time, self.end_time), 1)


def straight_track(start, speed, heading):
    """Constant velocity.

    start : (2,), position at time 0, m; speed : m/s, not negative
    heading : direction of motion, radians from the x axis towards the y axis
    Raises ValueError for a negative speed or a value that is not finite.
    """
    start = require_shape("start", require_finite("start", start), (2,))
    require_not_negative("speed", speed)
    velocity = speed * _direction(heading)
    coefficients = np.stack([velocity, start])[:, None, :]
    return Track(PPoly(coefficients, [0.0, 1.0]), -np.inf, np.inf)


def passing_start(distance, time, speed, heading):
    """Where a vessel must start to pass the origin at a given distance and time.

    distance : at the closest approach, m; positive leaves the origin to the right of the vessel
    time : of the closest approach, s; speed : m/s; heading : radians from the x axis
    Returns (x, y), m, a start for `straight_track`. Raises ValueError for values that are not finite.
    """
    along = -require_finite("speed", speed) * require_finite("time", time)
    (cosine, sine), distance = _direction(heading), require_finite("distance", distance)
    return float(along * cosine - distance * sine), float(along * sine + distance * cosine)


def speed_profile_track(start, heading, time, speed):
    """A straight course along which the speed changes, linearly between the given points.

    start : (2,), position at time[0], m; heading : radians from the x axis
    time : (n,), s, increasing; speed : (n,), m/s, not negative
    Raises ValueError for times that do not increase, a negative speed, or shapes that differ.
    """
    start = require_shape("start", require_finite("start", start), (2,))
    time = require_increasing("time", time)
    speed = require_shape("speed", require_not_negative("speed", speed), (time.size,))
    slope = np.diff(speed) / np.diff(time)
    distance = PPoly(np.stack([slope, speed[:-1]]), time).antiderivative()
    coefficients = distance.c[..., None] * _direction(heading)
    coefficients[-1] += start
    return Track(PPoly(coefficients, time), time[0], time[-1])


def course_track(start, speed, time, heading):
    """A constant speed along which the heading changes, linearly between the given points.

    start : (2,), position at time[0], m; speed : m/s, not negative
    time : (n,), s, increasing; heading : (n,), radians from the x axis
    Returns a Track of cubic arcs that turn by at most 0.05 rad each, so that the speed is constant to 1e-6.
    Raises ValueError for times that do not increase, a negative speed, or shapes that differ.
    """
    start = require_shape("start", require_finite("start", start), (2,))
    speed = require_not_negative("speed", speed)
    time = require_increasing("time", time)
    heading = require_shape("heading", require_finite("heading", heading), (time.size,))
    parts = np.ceil(np.abs(np.diff(heading)) / 0.05).astype(int) + 1
    knots = [
        np.linspace(*ends, n, endpoint=False) for *ends, n in zip(time[:-1], time[1:], parts, strict=True)
    ]
    knots = np.append(np.concatenate(knots), time[-1])
    angle = np.interp(knots, time, heading)
    chord = np.diff(knots) * np.sinc(np.diff(angle) / (2 * np.pi))
    steps = speed * chord[:, None] * _direction((angle[1:] + angle[:-1]) / 2).T
    position = start + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    return Track(CubicHermiteSpline(knots, position, speed * _direction(angle).T), time[0], time[-1])


def waypoint_track(time, position):
    """A smooth path through known points (a cubic spline).

    time : (n,), s, increasing, n >= 2; position : (n, 2), m
    Raises ValueError for times that do not increase or shapes that differ.
    """
    time = require_increasing("time", time)
    position = require_shape("position", require_finite("position", position), (time.size, 2))
    spline = CubicSpline(time, position, bc_type="natural")
    return Track(spline, time[0], time[-1])


def load_track(path, origin=None):
    """Read a recorded GPS or AIS track of one vessel from a CSV file with a header line.

    Columns: `time` (s, or ISO 8601 date and time, UTC unless it says otherwise; one kind in all rows), and
    either `x`, `y` (m, east and north) or `latitude`, `longitude` (degrees; read as metres east and north of
    the origin); x and y where a file has both. The names lat, lon, timestamp and BaseDateTime are understood.
    Other columns are left alone; the first time becomes 0.
    origin : what becomes (0, 0), say the sensor, in the file's unit: (x, y) or (latitude, longitude);
        if None, the zero of x and y, or the first latitude and longitude
    Returns a Track through the points. Raises ValueError naming the file and what is wrong: a column missing
    or there twice, fewer than two rows, a value that is not a number, times unsorted, repeated or not of
    one kind.
    """
    name = Path(path).name
    with open(path, newline="", encoding="utf-8-sig") as file:
        reader = csv.DictReader(file, skipinitialspace=True)
        try:
            rows, header = list(reader), reader.fieldnames or []
        except (UnicodeDecodeError, csv.Error):
            raise ValueError(f"{name} must be a CSV file of text in UTF-8") from None
    long = next((n for n, row in enumerate(rows, 2) if None in row), None)
    if long is not None:
        raise ValueError(
            f"{name}: row {long} has more values than the header has columns; are there decimal commas?"
        )
    columns = _columns(name, header)
    pair = next((pair for pair in (("x", "y"), ("latitude", "longitude")) if set(pair) <= set(columns)), None)
    if "time" not in columns or pair is None:
        raise ValueError(
            f"{name} must have the columns time and x, y or time and latitude, longitude, "
            f"but has {', '.join(columns) or 'none'}"
        )
    if len(rows) < 2:
        raise ValueError(f"{name} must have at least 2 rows of positions, but has {len(rows)}")
    time = _times(name, [row[columns["time"]] for row in rows])
    values = np.array([[_number(name, n, c, row[columns[c]]) for c in pair] for n, row in enumerate(rows, 2)])
    time = require_increasing(f"time in {name}", time - time[0])
    geographic = pair[0] == "latitude"
    zero = values[0] if geographic else np.zeros(2)
    zero = zero if origin is None else require_shape("origin", require_finite("origin", origin), (2,))
    return waypoint_track(time, _metres(name, values, zero) if geographic else values - zero)


def retarded_time(track, height, time, sound_speed):
    """The time at which the sound heard at `time` by a sensor at the origin left the source.

    Solves c (t - tau) = |source(tau)| by Newton's method to below 1e-9 m.
    track : Track; height : of the source above the sensor, m; time : (...), s; sound_speed : m/s
    Returns tau (...), s. Raises ValueError for a source that is not slower than sound.
    """
    time = require_finite("time", time)
    require_positive("sound_speed", sound_speed)
    emitted = np.array(time, dtype=float)
    for _ in range(50):
        position, velocity = track.position(emitted), track.velocity(emitted)
        distance = np.sqrt(np.sum(position**2, axis=-1) + height**2)
        range_rate = np.sum(position * velocity, axis=-1) / np.maximum(distance, 1e-12)
        miss = distance - sound_speed * (time - emitted)
        if np.any(np.abs(range_rate) >= sound_speed):
            raise ValueError(f"the source must be slower than sound, {sound_speed:g} m/s")
        emitted = emitted - miss / (range_rate + sound_speed)
        if np.all(np.abs(miss) < 1e-9):
            break
    return emitted


def require_increasing(name, time):
    """Return `time` as a float array (n,), n >= 2; raise ValueError unless it is finite and increases."""
    time = require_shape(name, require_finite(name, time), (None,))
    if time.size < 2:
        raise ValueError(f"{name} must have at least 2 values, but {time.size} was given")
    steps = np.diff(time)
    if np.any(steps <= 0):
        bad = int(np.argmax(steps <= 0))
        raise ValueError(f"{name} must increase, but {time[bad + 1]:g} follows {time[bad]:g}")
    return time


def _direction(heading):
    heading = require_finite("heading", heading)
    return np.array([np.cos(heading), np.sin(heading)])


def _columns(name, header):
    """The file's name of each column by what it means; two columns of one meaning are refused."""
    columns = {}
    for column in header:
        meaning = (column or "").strip().lower()
        meaning = OTHER_NAMES.get(meaning, meaning)
        if meaning in COLUMNS and meaning in columns:
            raise ValueError(
                f"{name} must have one column of {meaning}, but has {columns[meaning]!r} and {column!r}"
            )
        columns[meaning] = column
    return columns


def _times(name, texts):
    """The times of all rows, s, each read as the first one is: as a number, or as a date and time."""
    dated = _parsed(float, texts[0]) is None
    parse, kind = (_moment, "a date and time") if dated else (float, "seconds")
    times = []
    for line, text in enumerate(texts, 2):
        times.append(_parsed(parse, text))
        if times[-1] is None:
            allowed = "seconds or a date and time" if line == 2 else f"{kind} as in line 2"
            raise ValueError(f"{name}, line {line}: time must be {allowed}, but is {text!r}")
    return np.array(times)


def _moment(text):
    moment = datetime.fromisoformat(text.strip())
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def _parsed(parse, text):
    """The value that `parse` finds in a cell, or None."""
    try:
        return parse(text)
    except (AttributeError, TypeError, ValueError):
        return None


def _number(name, line, column, text):
    value = _parsed(float, text)
    if value is None or not np.isfinite(value):
        raise ValueError(f"{name}, line {line}: {column} must be a finite number, but is {text!r}")
    return value


def _metres(name, degrees, origin):
    if np.any(np.abs(degrees[:, 0]) > 90) or np.any(np.abs(degrees[:, 1]) > 360):
        raise ValueError(f"{name}: latitude must lie within 90 degrees and longitude within 360 degrees of 0")
    latitude, longitude = np.radians(degrees).T
    north, east = np.radians(origin)
    turn = np.unwrap(np.concatenate([[0.0], longitude - east]))[1:]
    return EARTH_RADIUS * np.stack([np.cos(north) * turn, latitude - north], axis=-1)
