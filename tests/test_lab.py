"""The bridge from sliders to pictures, tested with a small model and view."""

import io

import numpy as np
import pytest
from PIL import Image

from labsim.lab import Lab, choice, interval, show_source, slider, still, switch
from labsim.views import style


class WaveView:
    """A sine curve; its axis grows when the amplitude leaves it."""

    def __init__(self):
        self.figure = style.figure(4, 3)
        self.axes = self.figure.subplots()
        self.axes.set(xlim=(0, 1), ylim=(-1, 1), xlabel="time (s)", ylabel="height (m)")
        (self.curve,) = self.axes.plot([], [])
        self.title = self.axes.set_title("A wave")
        style.animate(self.curve, self.title)

    def draw(self, result):
        time, height = result
        self.curve.set_data(time, height)
        top = max(1.0, np.ceil(height.max()))
        if top != self.axes.get_ylim()[1]:
            self.axes.set_ylim(-top, top)
        self.title.set_text(f"A wave of {height.max():.1f} m")
        return f"The wave is {height.max():.1f} m high."


def wave(amplitude, turns=2.0):
    """A sine of the given amplitude; refuses a flat one."""
    if amplitude == 0:
        raise ValueError("amplitude must not be 0")
    if amplitude == -1:
        raise KeyError("lost")
    if amplitude == 5:
        np.linalg.inv(np.zeros((2, 2)))
    time = np.linspace(0, 1, 201)
    return time, amplitude * np.sin(2 * np.pi * turns * time)


@pytest.fixture
def lab():
    return Lab(
        wave, WaveView(), amplitude=slider("Amplitude (m)", -1, 5, 1), turns=slider("Turns", 1.0, 9.0, 2.0)
    )


def pixels(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=int)


def test_moving_a_slider_changes_picture_and_sentence(lab):
    before = lab._picture.value
    lab.controls["turns"].value = 5.0
    assert lab._picture.value != before
    assert lab.sentence == "The wave is 1.0 m high."


def test_blitted_picture_is_the_picture_drawn_whole(lab):
    for turns in (3.0, 7.0, 4.0):
        lab.controls["turns"].value = turns
    fresh = Lab(
        wave, WaveView(), amplitude=slider("Amplitude (m)", -1, 5, 1), turns=slider("Turns", 1.0, 9.0, 4.0)
    )
    assert np.array_equal(pixels(lab._picture.value), pixels(fresh._picture.value))


def test_background_is_kept_until_the_axis_changes(lab):
    background = lab._painter._background
    lab.controls["turns"].value = 5.0
    assert lab._painter._background is background
    lab.controls["amplitude"].value = 4
    assert lab._painter._background is not background


def test_refused_value_is_said_in_words_and_the_picture_stays(lab):
    before = lab._picture.value
    lab.controls["amplitude"].value = 0
    assert "amplitude must not be 0" in lab._status.value
    assert lab._picture.value == before
    lab.controls["amplitude"].value = 1
    assert "The wave is 1.0 m high." in lab._status.value


@pytest.mark.parametrize(("amplitude", "named"), [(-1, "KeyError"), (5, "LinAlgError: Singular matrix")])
def test_fault_in_a_model_shows_no_stack_trace(lab, amplitude, named):
    lab.controls["amplitude"].value = amplitude
    assert "A fault of the lab" in lab._status.value and named in lab._status.value


def test_fault_while_building_is_raised():
    with pytest.raises(KeyError):
        Lab(wave, WaveView(), amplitude=slider("Amplitude (m)", -1, 5, -1))


def test_reset_puts_every_control_back_in_one_step(lab, monkeypatch):
    first = lab._picture.value
    lab.controls["turns"].value, lab.controls["amplitude"].value = 6.0, 0
    steps = []
    monkeypatch.setattr(lab, "update", lambda whole=lab.update: (steps.append(1), whole()))
    lab.reset()
    assert (lab._picture.value, len(steps)) == (first, 1)
    assert "The wave is" in lab._status.value


def test_saved_notebook_keeps_a_picture_and_its_sentence(lab):
    data, metadata = lab._repr_mimebundle_()
    assert data["text/plain"] == "The wave is 1.0 m high."
    assert metadata["image/png"]["alt"] == data["text/plain"]
    assert pixels(data["image/png"]).shape == (300, 400, 3)
    assert "application/vnd.jupyter.widget-view+json" in data


def test_still_shows_the_same_picture_without_sliders(lab):
    data, _ = still(WaveView(), wave(1))._repr_mimebundle_()
    assert data["image/png"] == lab._repr_mimebundle_()[0]["image/png"]
    assert data["text/plain"] == lab.sentence


class FieldView:
    """A field of many colours with one thin line over it."""

    def __init__(self):
        self.figure = style.figure(6, 4)
        self.axes = self.figure.subplots()
        self.axes.imshow(np.random.default_rng(1).random((200, 300)), aspect="auto", extent=(0, 1, 0, 1))
        self.axes.plot([0.1, 0.9], [0.2, 0.8], color=style.PINK, linewidth=3)

    def draw(self, _):
        return "A line lies over a field."


def test_few_colours_keep_that_of_a_thin_line_over_a_field():
    """Each pixel of the saved picture is within 24 of 255 of the drawn one; the median cut is 56 off."""
    shown = still(FieldView(), None)
    saved = pixels(shown._repr_mimebundle_()[0]["image/png"])
    assert np.max(np.abs(saved - np.asarray(shown._image, dtype=int))) < 24


def test_sentence_is_escaped():
    class Sharp(WaveView):
        def draw(self, result):
            super().draw(result)
            return "a < b & c"

    assert "a &lt; b &amp; c" in Lab(wave, Sharp(), amplitude=slider("Amplitude (m)", 1, 5, 1))._status.value


def test_rounding_by_the_browser_does_not_reach_the_model(lab):
    seen = []
    lab.model = lambda **values: seen.append(values) or wave(**values)
    lab.controls["turns"].value = 5.000000000000001
    assert seen[-1]["turns"] == 5.0


def test_controls_give_the_model_what_it_expects():
    assert type(slider("n", 1, 5, 2).value) is int
    assert slider("x", 0.0, 1.0, 0.5).step == pytest.approx(0.01)
    assert slider("x", 0.01, 100, 1.0, log=True).max == pytest.approx(2)
    assert interval("x", 0, 10, (2, 3)).value == (2, 3)
    assert interval("x", 0, 10, (10, 10)).value == (10, 10)
    assert choice("c", {"first": 10, "second": 20}).value == 10
    assert choice("c", ["a", "b"], "b").value == "b"
    assert switch("s", True).value is True


def test_start_off_the_steps_is_refused_since_a_browser_would_move_it():
    with pytest.raises(ValueError, match="whole number of steps of 0.5"):
        slider("Depth (m)", 0.0, 5.0, 1.2, step=0.5)
    with pytest.raises(ValueError, match="between its ends"):
        slider("Depth (m)", 0.0, 5.0, 6.0)
    with pytest.raises(ValueError, match="two numbers in order between its ends"):
        interval("Depth (m)", 0.0, 5.0, (4.0, 6.0))


def test_logarithmic_slider_needs_a_low_end_above_zero():
    with pytest.raises(ValueError, match="low of 'Ratio' must be above 0"):
        slider("Ratio", 0.0, 10.0, 1.0, log=True)


@pytest.mark.parametrize(("low", "high", "start"), [(0.05, 5, 0.5), (0.1, 100, 1), (0.02, 20, 0.333)])
def test_start_of_a_logarithmic_slider_lies_on_its_steps(low, high, start):
    control = slider("Ratio", low, high, start, log=True)
    steps = (np.log10(start) - control.min) / control.step
    assert steps == pytest.approx(round(steps), abs=1e-9)
    assert control.value == start


def test_labels_stand_above_the_controls(lab):
    panel = lab.widget.children[0].children
    assert [box.children[0].value for box in panel[:2]] == ["Amplitude (m)", "Turns"]
    assert panel[0].children[1] is lab.controls["amplitude"]


def test_source_is_shown_as_code():
    data = show_source(wave, pixels)._repr_mimebundle_()
    assert data["text/plain"].startswith("def wave(") and "def pixels(" in data["text/plain"]
    assert "<pre" in data["text/html"]
