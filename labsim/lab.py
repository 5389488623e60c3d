"""The bridge from sliders to pictures: model (numbers) -> view (picture and sentence) -> widget.

The picture is drawn by blitting: what no slider moves is drawn once and kept, and each step draws
the animated artists over it. matplotlib marks the figure stale when anything else changed (axis
limits, say); only then is the background drawn anew.
"""

import inspect
import io
from html import escape

import ipywidgets
import numpy as np
from PIL import Image
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

from labsim.arguments import require_positive

__all__ = ["Lab", "choice", "interval", "show_source", "slider", "still", "switch"]


def slider(label, low, high, start, step=None, log=False):
    """A number between low and high; whole if all are whole. `log` spaces the steps by equal factors.

    Raises ValueError for a start outside, or off the steps counted from low: a browser would move it.
    """
    if log:
        require_positive(f"low of {label!r}", low)
    whole = all(isinstance(number, int) for number in (low, high, start, step or 1)) and not log
    ends = (np.log10(low), np.log10(high), np.log10(start)) if log else (low, high, start)
    step = _step(label, *ends, step or (1 if whole else None))
    if log:
        return ipywidgets.FloatLogSlider(
            start, min=ends[0], max=ends[1], step=step, description=label, readout_format=".3g"
        )
    kind = ipywidgets.IntSlider if whole else ipywidgets.FloatSlider
    return kind(start, min=low, max=high, step=step, description=label, readout_format=_readout(whole, step))


def interval(label, low, high, start, step=None):
    """Two numbers between low and high, the first not above the second."""
    if not low <= start[0] <= start[1] <= high:
        raise ValueError(f"start of {label!r} must be two numbers in order between its ends, but is not")
    step = step or (high - low) / 100
    return ipywidgets.FloatRangeSlider(
        value=start, min=low, max=high, step=step, description=label, readout_format=_readout(False, step)
    )


def choice(label, options, start=None):
    """One of `options`: a list, or a dict from what is shown to what the model gets."""
    values = list(options.values()) if isinstance(options, dict) else list(options)
    start = values[0] if start is None else start
    return ipywidgets.Dropdown(options=options, value=start, description=label)


def switch(label, start=False):
    """True or False."""
    return ipywidgets.Checkbox(start, description=label, indent=False)


class Lab:
    """Sliders above a picture above a sentence; ending a cell with a Lab shows it.

    model : function of the controls' values, by name; a ValueError it raises is shown in words
    view : has `figure`, and `draw(result)`, which moves the animated artists and returns the sentence
    controls : slider(...), interval(...), choice(...) or switch(...) by the model's argument names
    Where no kernel runs (a web page of the notebook) the last picture and its sentence remain.
    """

    def __init__(self, model, view, **controls):
        self.model, self.view, self.controls = model, view, controls
        self._painter = _Painter(view.figure)
        self._start = {name: control.value for name, control in controls.items()}
        fitting = ipywidgets.Layout(max_width="100%", align_self="flex-start")
        self._picture = ipywidgets.Image(format="png", layout=fitting)
        self._status = ipywidgets.HTML()
        reset = ipywidgets.Button(
            description="Reset",
            tooltip="Put every control back",
            icon="undo",
            layout={"align_self": "flex-end"},
        )
        reset.on_click(lambda _: self.reset())
        for control in controls.values():
            control.observe(self._changed, names="value")
        columns = ipywidgets.Layout(
            grid_template_columns="repeat(auto-fill, minmax(17em, 1fr))", grid_gap="0 2em"
        )
        panel = ipywidgets.GridBox([*map(_labelled, controls.values()), reset], layout=columns)
        self.widget = ipywidgets.VBox([panel, self._picture, self._status])
        self.update()

    def update(self):
        """Compute, draw and show the picture for the present controls; raises what the model raises."""
        result = self.model(**{name: _value(control) for name, control in self.controls.items()})
        self.sentence = self.view.draw(result)
        self._picture.value = _png(self._painter.paint())
        self._say(escape(self.sentence))

    def reset(self):
        """Put every control back to where it began."""
        for name, control in self.controls.items():
            control.unobserve(self._changed, names="value")
            control.value = self._start[name]
            control.observe(self._changed, names="value")
        self._changed(None)

    def _changed(self, _):
        try:
            self.update()
        except Exception as error:
            # numpy's failures in linear algebra are ValueErrors, too, but no answer to what was asked
            if isinstance(error, ValueError) and not isinstance(error, np.linalg.LinAlgError):
                self._say(
                    f"<b>Not possible:</b> {escape(str(error))}. The picture is that of the step before."
                )
            else:
                said = f"{type(error).__name__}: {error}"
                self._say(f"<b>A fault of the lab, not yours:</b> {escape(said)}")

    def _say(self, html):
        self._status.value = f'<div role="status" aria-live="polite" style="line-height:1.4">{html}</div>'

    def _repr_mimebundle_(self, **_):
        data, metadata = _still_bundle(self._painter.paint(), self.sentence)
        return {**self.widget._repr_mimebundle_(), **data}, metadata


def still(view, result, name=None, **parameters):
    """The picture of one result with its sentence, without sliders; ending a cell with it shows it.

    name : of a picture that reproduces one of a paper's, such as "paper1_figure4", with the parameters
        that made it; `python3 -m labsim figures` writes these to files
    """
    return Still(view, result, name, parameters)


def show_source(*functions):
    """The source of functions of the lab, as a student should read it."""
    return _Source("\n\n".join(inspect.getsource(function) for function in functions))


class _Source:
    def __init__(self, text):
        self.text = text

    def _repr_mimebundle_(self, **_):
        code = highlight(self.text, PythonLexer(), HtmlFormatter(noclasses=True, nowrap=True))
        look = "background:#f7f7f7; color:#222; padding:0.6em; white-space:pre; overflow-x:auto"
        return {"text/html": f'<pre style="{look}">{code}</pre>', "text/plain": self.text}


class Still:
    """A picture without sliders; made by `still`."""

    def __init__(self, view, result, name, parameters):
        self.sentence = view.draw(result)
        self.figure, self.name, self.parameters = view.figure, name, parameters
        self._image = _Painter(view.figure).paint()

    def _repr_mimebundle_(self, **_):
        return _still_bundle(self._image, self.sentence)


class _Painter:
    """Draws a figure to an image, keeping the background between calls."""

    def __init__(self, figure):
        self.figure = figure
        self._background = None

    def paint(self):
        canvas = self.figure.canvas
        if self._background is None or self.figure.stale:
            self._capture(canvas)
        canvas.restore_region(self._background)
        for artist in self._animated:
            artist.draw(canvas.get_renderer())
        return Image.frombuffer("RGBA", canvas.get_width_height(), canvas.buffer_rgba()).convert("RGB")

    def _capture(self, canvas):
        canvas.draw()
        self.figure.set_layout_engine("none")
        self.figure.stale = False
        self._background = canvas.copy_from_bbox(self.figure.bbox)
        animated = self.figure.findobj(lambda artist: artist.get_animated())
        self._animated = sorted(animated, key=lambda artist: artist.get_zorder())


def _png(image, colours=None, compression=1):
    if colours:
        image = image.quantize(colours, Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE)
    buffer = io.BytesIO()
    image.save(buffer, format="png", compress_level=compression)
    return buffer.getvalue()


def _still_bundle(image, sentence):
    data = {"image/png": _png(image, colours=256, compression=9), "text/plain": sentence}
    return data, {"image/png": {"alt": sentence}}


def _value(control):
    # A browser sends 5 back as 5.000000000000001.
    return float(f"{control.value:.12g}") if isinstance(control.value, float) else control.value


def _step(label, low, high, start, step):
    if not low <= start <= high:
        raise ValueError(f"start of {label!r} must lie between its ends, but does not")
    if step is None:
        step = (high - low) / 100
        return (start - low) / max(1, round((start - low) / step)) if start > low else step
    if abs((start - low) / step - round((start - low) / step)) > 1e-6:
        raise ValueError(f"start of {label!r} must lie a whole number of steps of {step:g} above its low end")
    return step


def _labelled(control):
    """A control under its label, so that the words take nothing from the track."""
    if isinstance(control, ipywidgets.Checkbox):
        control.layout = ipywidgets.Layout(align_self="flex-end", width="auto")
        return control
    label = ipywidgets.Label(control.description)
    control.description, control.tooltip = "", control.description
    control.layout = ipywidgets.Layout(width="auto", margin="-6px 0 0 0")
    return ipywidgets.VBox([label, control])


def _readout(whole, step):
    return "d" if whole else f".{max(0, int(np.ceil(-np.log10(step) - 1e-9)))}f"
