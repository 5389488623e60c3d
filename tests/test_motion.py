"""Tracks go where they say, and sound takes the time it takes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsim.motion import (
    EARTH_RADIUS,
    course_track,
    load_track,
    passing_start,
    retarded_time,
    speed_profile_track,
    straight_track,
    waypoint_track,
)

TIME = np.linspace(0.0, 60.0, 241)
ANGLES = st.floats(-np.pi, np.pi)
SPEEDS = st.floats(0.0, 30.0)


def assert_velocity_is_the_slope_of_position(track, time):
    slope = (track.position(time + 1e-4) - track.position(time - 1e-4)) / 2e-4
    np.testing.assert_allclose(track.velocity(time), slope, atol=1e-6)


# Kinds of tracks


@given(heading=ANGLES, speed=SPEEDS)
def test_a_straight_track_covers_speed_times_time(heading, speed):
    track = straight_track((3.0, -4.0), speed, heading)
    travelled = track.position(10.0) - track.position(0.0)
    np.testing.assert_allclose(
        travelled, 10 * speed * np.array([np.cos(heading), np.sin(heading)]), atol=1e-9
    )
    np.testing.assert_allclose(track.position(-10.0), [3.0, -4.0] - travelled, atol=1e-9)


def test_a_speed_profile_covers_the_area_under_it():
    track = speed_profile_track((0.0, 5.0), 0.0, [0.0, 10.0, 30.0], [4.0, 8.0, 0.0])
    np.testing.assert_allclose(track.position([0.0, 10.0, 30.0])[:, 0], [0.0, 60.0, 140.0])
    np.testing.assert_allclose(track.velocity([5.0, 20.0])[:, 0], [6.0, 4.0])
    np.testing.assert_allclose(track.position(TIME)[:, 1], 5.0)
    assert_velocity_is_the_slope_of_position(track, np.array([3.0, 17.0]))


@settings(max_examples=25, deadline=None)
@given(speed=st.floats(0.1, 30.0), first=ANGLES, turn=st.floats(-3.0, 3.0))
def test_a_course_track_keeps_its_speed_and_turns_on_a_circle(speed, first, turn):
    track = course_track((1.0, 2.0), speed, [0.0, 40.0], [first, first + turn])
    velocity = track.velocity(np.linspace(0.0, 40.0, 97))
    np.testing.assert_allclose(np.linalg.norm(velocity, axis=-1), speed, rtol=1e-6)
    chord = np.linalg.norm(track.position(40.0) - track.position(0.0))
    assert chord == pytest.approx(40 * speed * np.sinc(turn / 2 / np.pi), rel=1e-9)


def test_a_course_track_is_straight_before_and_after_its_turn():
    track = course_track((0.0, 0.0), 10.0, [0.0, 20.0, 30.0, 60.0], [0.0, 0.0, np.pi / 2, np.pi / 2])
    np.testing.assert_allclose(track.position(20.0), [200.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(track.position(60.0) - track.position(30.0), [0.0, 300.0], atol=1e-9)
    radius = 10.0 / (np.pi / 20)
    np.testing.assert_allclose(track.position(30.0), [200.0 + radius, radius], atol=1e-9)
    assert_velocity_is_the_slope_of_position(track, np.array([5.0, 25.1, 50.0]))


def test_a_waypoint_track_goes_through_its_points():
    points = np.random.default_rng(2).normal(scale=50.0, size=(7, 2))
    time = np.array([0.0, 3.0, 10.0, 11.0, 20.0, 40.0, 41.0])
    track = waypoint_track(time, points)
    np.testing.assert_allclose(track.position(time), points, atol=1e-9)
    assert_velocity_is_the_slope_of_position(track, np.array([1.0, 15.0, 33.0]))
    np.testing.assert_allclose(waypoint_track([0.0, 2.0], points[:2]).position(1.0), points[:2].mean(axis=0))


def test_every_track_runs_straight_on_beyond_its_ends():
    track = waypoint_track([0.0, 1.0, 2.0], [[0.0, 0.0], [1.0, 1.0], [3.0, 0.0]])
    beyond = track.position([2.0, 7.0])
    np.testing.assert_allclose(beyond[1] - beyond[0], 5 * track.velocity(2.0))
    np.testing.assert_allclose(track.velocity(9.0), track.velocity(2.0))


@given(
    distance=st.floats(-500.0, 500.0), time=st.floats(0.0, 60.0), speed=st.floats(1.0, 20.0), heading=ANGLES
)
def test_a_passing_vessel_is_closest_where_and_when_it_was_told(distance, time, speed, heading):
    track = straight_track(passing_start(distance, time, speed, heading), speed, heading)
    closest = track.position(time)
    assert np.linalg.norm(closest) == pytest.approx(abs(distance), abs=1e-6)
    assert closest @ track.velocity(time) == pytest.approx(0.0, abs=1e-6)


# Retarded time

TRACKS = {
    "straight": straight_track((-250.0, 100.0), 12.0, np.pi / 18),
    "profile": speed_profile_track((-250.0, 100.0), 0.2, [0.0, 30.0, 60.0], [4.0, 15.0, 5.0]),
    "turning": course_track((-250.0, 50.0), 12.0, [0.0, 20.0, 40.0, 60.0], [0.0, 0.0, 1.5, 1.5]),
    "recorded": waypoint_track(
        np.arange(0.0, 61.0, 10.0), np.random.default_rng(3).normal(0.0, 60.0, (7, 2))
    ),
}


@pytest.mark.parametrize("kind", TRACKS)
def test_sound_covers_the_range_in_its_travel_time_to_a_micrometre(kind):
    track = TRACKS[kind]
    emitted = retarded_time(track, 100.0, TIME, 1500.0)
    distance = np.sqrt(np.sum(track.position(emitted) ** 2, axis=-1) + 100.0**2)
    np.testing.assert_allclose(distance, 1500.0 * (TIME - emitted), rtol=0, atol=1e-6)


def test_retarded_time_agrees_with_the_closed_form_for_uniform_motion():
    # c^2 (t - tau)^2 = |P0 + u tau|^2, a quadratic in tau.
    emitted = retarded_time(TRACKS["straight"], 100.0, TIME, 1500.0)
    start, velocity = np.array([-250.0, 100.0, 100.0]), np.append(TRACKS["straight"].velocity(0.0), 0.0)
    q = 1500.0**2 - velocity @ velocity
    b = start @ velocity + 1500.0**2 * TIME
    expected = (b - np.sqrt(b**2 - q * (1500.0**2 * TIME**2 - start @ start))) / q
    np.testing.assert_allclose(emitted, expected, atol=1e-9)
    assert np.max(TIME - emitted) == pytest.approx(0.345, abs=0.001)


@given(heading=ANGLES, speed=SPEEDS, height=st.floats(1.0, 500.0), time=st.floats(0.0, 60.0))
def test_the_sound_never_arrives_before_it_leaves(heading, speed, height, time):
    track = straight_track((-100.0, 40.0), speed, heading)
    assert time - retarded_time(track, height, time, 1500.0) >= height / 1500.0 - 1e-12


@given(turn=ANGLES)
def test_the_travel_time_does_not_know_where_north_is(turn):
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    turned = straight_track(rotation @ [-250.0, 100.0], 12.0, np.pi / 18 + turn)
    expected = retarded_time(TRACKS["straight"], 100.0, TIME, 1500.0)
    np.testing.assert_allclose(retarded_time(turned, 100.0, TIME, 1500.0), expected, atol=1e-9)


# Recorded tracks


def write(tmp_path, text):
    path = tmp_path / "ship.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_recorded_track_in_metres(tmp_path):
    track = load_track(write(tmp_path, "time,x,y,note,note\n100,0,5,hello,\n110,50,5,,\n120,100,5,,\n"))
    assert (track.start_time, track.end_time) == (0.0, 20.0)
    np.testing.assert_allclose(track.position([0.0, 5.0, 20.0]), [[0, 5], [25, 5], [100, 5]], atol=1e-9)


@pytest.mark.parametrize(
    "header", ["time,latitude,longitude", "BaseDateTime,LAT,LON", "\ufeffTimestamp, Lat , Lon"]
)
def test_a_recorded_track_in_degrees(tmp_path, header):
    rows = (
        "2024-05-01T10:00:00Z,60.0,5.0",
        "2024-05-01T12:00:10+02:00,60.001,5.0",
        "2024-05-01 10:00:20,60.001,5.002",
    )
    track = load_track(write(tmp_path, "\n".join([header, *rows])))
    degree = EARTH_RADIUS * np.pi / 180
    expected = [[0, 0], [0, 0.001 * degree], [0.002 * degree / 2, 0.001 * degree]]
    np.testing.assert_allclose(track.position([0.0, 10.0, 20.0]), expected, rtol=1e-6, atol=1e-6)


def test_a_recorded_track_seen_from_a_sensor(tmp_path):
    path = write(tmp_path, "time,latitude,longitude\n0,60.0,5.0\n10,60.001,5.002\n")
    degree = EARTH_RADIUS * np.pi / 180
    start = load_track(path, origin=(60.0005, 5.001)).position(0.0)
    np.testing.assert_allclose(start, [-0.001 * degree * np.cos(np.radians(60.0005)), -0.0005 * degree])
    path = write(tmp_path, "time,x,y\n0,3,4\n10,5,6\n")
    np.testing.assert_allclose(load_track(path, origin=(3.0, 5.0)).position([0.0, 10.0]), [[0, -1], [2, 1]])
    with pytest.raises(ValueError, match="origin must have shape"):
        load_track(path, origin=(1.0, 2.0, 3.0))


def test_a_track_across_the_date_line_stays_in_one_piece(tmp_path):
    track = load_track(write(tmp_path, "time,latitude,longitude\n0,0,179.999\n10,0,-179.999\n"))
    assert track.position(10.0)[0] == pytest.approx(0.002 * EARTH_RADIUS * np.pi / 180)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "must have the columns time and x, y or time and latitude, longitude, but has none"),
        ("time,x\n0,0\n1,1\n", "must have the columns .* but has time, x"),
        ("x,y\n0,0\n1,1\n", "must have the columns .* but has x, y"),
        ("time,latitude,y\n0,0,0\n1,1,1\n", "must have the columns"),
        ("time,x,y\n", "must have at least 2 rows of positions, but has 0"),
        ("time,x,y\n0,0,0\n", "must have at least 2 rows of positions, but has 1"),
        ("time,x,y\n0,0,0\n1,east,0\n", "line 3: x must be a finite number, but is 'east'"),
        ("time,x,y\n0,0,0\n1,0\n", "line 3: y must be a finite number, but is None"),
        ("time,x,y\n0,0,nan\n1,0,0\n", "line 2: y must be a finite number, but is 'nan'"),
        ("time,x,y\nnoon,0,0\n1,0,0\n", "line 2: time must be seconds or a date and time, but is 'noon'"),
        ("time,x,y\n0,0,0\n2024-05-01T10:00:05Z,1,1\n", "line 3: time must be seconds as in line 2, but is"),
        ("time,x,y\n2024-05-01T10:00:05Z,0,0\n5,1,1\n", "line 3: time must be a date and time as in line 2"),
        ("time,timestamp,x,y\n0,9,0,0\n1,8,1,1\n", "one column of time, but has 'time' and 'timestamp'"),
        ("time,lat,lon,Latitude\n0,0,0,0\n1,1,1,1\n", "one column of latitude, but has 'lat' and 'Latitude'"),
        ("time,x,y\n0,0,0\ninf,0,0\n", "time in ship.csv must be finite"),
        ("time,x,y\n0,0,0\n2,0,0\n1,0,0\n", "time in ship.csv must increase, but 1 follows 2"),
        ("time,x,y\n0,0,0\n1,0,0\n1,0,0\n", "time in ship.csv must increase, but 1 follows 1"),
        ("time,latitude,longitude\n0,91,0\n1,0,0\n", "latitude must lie within 90 degrees"),
        ("time,latitude,longitude\n0,59,90,10,70\n1,59,91,10,71\n", "row 2 has more values than the header"),
    ],
)
def test_a_recorded_track_that_cannot_be_read_is_refused_in_words(tmp_path, text, words):
    with pytest.raises(ValueError, match=words):
        load_track(write(tmp_path, text))


def test_a_file_that_is_not_text_is_refused_in_words(tmp_path):
    path = tmp_path / "ship.csv"
    path.write_bytes(bytes(range(256)))
    with pytest.raises(ValueError, match="ship.csv must be a CSV file of text in UTF-8"):
        load_track(path)


# Bad input


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: straight_track((0.0, 0.0), -1.0, 0.0), "speed must not be negative, but -1 was given"),
        (lambda: straight_track((0.0, np.nan), 1.0, 0.0), "start must be finite"),
        (lambda: straight_track((0.0, 0.0, 0.0), 1.0, 0.0), "start must have shape"),
        (lambda: straight_track((0.0, 0.0), 1.0, np.inf), "heading must be finite"),
        (lambda: speed_profile_track((0.0, 0.0), 0.0, [0.0, 1.0], [1.0, -2.0]), "speed must not be negative"),
        (
            lambda: speed_profile_track((0.0, 0.0), 0.0, [1.0, 0.0], [1.0, 2.0]),
            "time must increase, but 0 follows 1",
        ),
        (lambda: speed_profile_track((0.0, 0.0), 0.0, [0.0, 1.0], [1.0] * 3), "speed must have shape"),
        (
            lambda: course_track((0.0, 0.0), 1.0, [0.0], [0.0]),
            "time must have at least 2 values, but 1 was given",
        ),
        (lambda: course_track((0.0, 0.0), -1.0, [0.0, 1.0], [0.0, 1.0]), "speed must not be negative"),
        (lambda: course_track((0.0, 0.0), 1.0, [0.0, 1.0], [0.0]), "heading must have shape"),
        (lambda: waypoint_track([0.0, 0.0], [[0.0, 0.0]] * 2), "time must increase, but 0 follows 0"),
        (lambda: waypoint_track([0.0, 1.0], [[0.0, 0.0]] * 3), "position must have shape"),
        (lambda: waypoint_track([0.0, 1.0], [[0.0, np.inf]] * 2), "position must be finite"),
        (lambda: passing_start(np.nan, 0.0, 1.0, 0.0), "distance must be finite"),
        (lambda: retarded_time(TRACKS["straight"], 100.0, np.nan, 1500.0), "time must be finite"),
        (lambda: retarded_time(TRACKS["straight"], 100.0, 0.0, -1500.0), "sound_speed must be above 0"),
        (lambda: retarded_time(TRACKS["straight"], 1.0, 60.0, 10.0), "the source must be slower than sound"),
    ],
)
def test_bad_input_is_refused_in_words(call, words):
    with pytest.raises(ValueError, match=words):
        call()
