"""Sound in shallow water: the trapped modes of a Pekeris waveguide and the field of a moving source.

A layer of water over a faster, denser sea bed traps sound in a few vertical standing waves, the normal
modes, each of which travels along the layer at its own speed; what a receiver hears is their sum. The
scene is that of Dong, Guo, Xu and Yan (Journal of Applied Acoustics 2020, section 3); the mode
equations are those of Pekeris (1948). Depth points down, a wave travels as exp(-i k r).
"""

from dataclasses import dataclass

import numpy as np

from labsim.arguments import (
    require_between,
    require_finite,
    require_interval,
    require_positive,
    require_shape,
    require_whole,
)
from labsim.motion import require_increasing
from labsim.noise import power_ratio

BISECTIONS = 60
NEPER_IN_DB = 20 / np.log(10)


@dataclass(frozen=True)
class PekerisWaveguide:
    """A layer of water over a fluid half space.

    depth : m; water_speed, bottom_speed : m/s; water_density, bottom_density : kg/m^3
    bottom_attenuation_db : dB per wavelength of sound in the bottom
    Raises ValueError for a bottom that is not faster than the water: it traps nothing.
    """

    depth: float = 45.0
    water_speed: float = 1505.0
    water_density: float = 1000.0
    bottom_speed: float = 1596.0
    bottom_density: float = 1600.0
    bottom_attenuation_db: float = 0.12

    def __post_init__(self):
        for name in ("depth", "water_speed", "water_density", "bottom_speed", "bottom_density"):
            require_positive(name, getattr(self, name))
        require_between("bottom_attenuation_db", self.bottom_attenuation_db, 0, 10)
        if self.bottom_speed <= self.water_speed:
            raise ValueError(
                f"bottom_speed must be above water_speed, {self.water_speed:g} m/s, "
                f"or no mode is trapped, but {self.bottom_speed:g} was given"
            )

    def cutoff_frequency(self, number):
        """The frequency above which mode `number` (1, 2, ...) is trapped, Hz."""
        slowness = np.sqrt(1 / self.water_speed**2 - 1 / self.bottom_speed**2)
        return (np.asarray(number) - 0.5) / (2 * self.depth * slowness)

    def mode_count(self, frequency):
        """How many modes are trapped at `frequency` (...), Hz."""
        spacing = self.cutoff_frequency(2) - self.cutoff_frequency(1)
        return np.ceil(np.asarray(frequency) / spacing - 0.5).clip(0).astype(int)


@dataclass(frozen=True)
class HorizontalArray:
    """A line of receivers along the x axis, centred on the origin, and how its sound is cut into frames.

    elements : count; spacing, depth : m; band : (low, high), Hz; sample_rate : Hz; frame : s
    Raises ValueError for fewer than two elements, a band outside half the rate, or one without a single bin.
    """

    elements: int = 64
    spacing: float = 0.5
    depth: float = 20.0
    band: tuple = (100.0, 500.0)
    sample_rate: float = 4000.0
    frame: float = 1.024

    def __post_init__(self):
        require_whole("elements", self.elements, 2, 4096)
        for name in ("spacing", "depth", "sample_rate", "frame"):
            require_positive(name, getattr(self, name))
        low, high = require_interval("band", self.band, 0, self.sample_rate / 2)
        if self.frequency.size == 0:
            raise ValueError(
                f"band must hold a multiple of {1 / self.frame:g} Hz, but ({low:g}, {high:g}) was given"
            )

    @property
    def positions(self):
        """Places of the receivers along the x axis (elements,), m."""
        return (np.arange(self.elements) - (self.elements - 1) / 2) * self.spacing

    @property
    def frequency(self):
        """The frequency bins of one frame that lie inside the band (bins,), Hz."""
        bins = np.fft.rfftfreq(round(self.frame * self.sample_rate), 1 / self.sample_rate)
        return bins[(bins >= self.band[0]) & (bins <= self.band[1])]


@dataclass(frozen=True)
class Modes:
    """The trapped modes of a waveguide over frequency; NaN where a mode is not trapped.

    frequency : (F,), Hz, increasing. The other arrays are (N, F), mode number first:
    vertical : vertical wavenumber in the water, 1/m; decay : of the mode below the sea bed, 1/m
    wavenumber : horizontal, of the lossless guide, 1/m; attenuation : of the amplitude, Np/m
    group_speed : m/s; amplitude : of the normalised mode shape, sqrt(kg/m^4)
    """

    waveguide: PekerisWaveguide
    frequency: np.ndarray
    vertical: np.ndarray
    decay: np.ndarray
    wavenumber: np.ndarray
    attenuation: np.ndarray
    group_speed: np.ndarray
    amplitude: np.ndarray

    @property
    def count(self):
        """How many modes are trapped at the highest frequency."""
        return self.vertical.shape[0]

    def shape(self, depth):
        """Normalised mode shapes at `depth` (...), m: the integral of shape^2 / density over all depths is 1.

        Returns (..., N, F), NaN where a mode is not trapped.
        """
        depth = np.asarray(depth, dtype=float)[..., None, None]
        in_water = np.minimum(depth, self.waveguide.depth)
        below = np.maximum(depth - self.waveguide.depth, 0)
        return self.amplitude * np.sin(self.vertical * in_water) * np.exp(-self.decay * below)


def solve_modes(waveguide, frequency):
    """All trapped modes at all frequencies.

    Mode n solves k_z H + arctan2(rho_2 k_z, rho_1 kappa) = n pi with kappa^2 = K^2 - k_z^2 and
    K^2 = (w/c_1)^2 - (w/c_2)^2: the left side grows with k_z, and there is exactly one root between
    (n - 1/2) pi / H and the smaller of n pi / H and K. Bisection cannot leave that bracket.
    Attenuation is first-order perturbation of the lossless mode. From 10 % above a mode's cutoff on, at the
    paper's loss, that is right to 0.6 % and the wavenumber to 2e-5; within 2 % of cutoff to 8 % and worse.
    waveguide : PekerisWaveguide; frequency : (F,), Hz, increasing, or one frequency
    Returns Modes. Raises ValueError for a frequency at which no mode is trapped.
    """
    frequency = np.atleast_1d(require_positive("frequency", frequency))
    if frequency.size > 1:
        require_increasing("frequency", frequency)
    cutoff = waveguide.cutoff_frequency(1)
    if frequency[0] <= cutoff:
        raise ValueError(
            f"frequency must be above {cutoff:.4g} Hz, where the first mode is trapped, "
            f"but {frequency[0]:g} was given"
        )
    number = np.arange(1, waveguide.mode_count(frequency[-1]) + 1)[:, None]
    omega = 2 * np.pi * frequency
    limit = omega * np.sqrt(1 / waveguide.water_speed**2 - 1 / waveguide.bottom_speed**2)
    low = (number - 0.5) * np.pi / waveguide.depth + 0 * limit
    low = np.where(low < limit, low, np.nan)
    high = np.minimum(number * np.pi / waveguide.depth, limit)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        above = characteristic(waveguide, frequency, middle, number) > 0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return _complete_modes(waveguide, frequency, (low + high) / 2)


def characteristic(waveguide, frequency, vertical, number):
    """k_z H + arctan2(rho_2 k_z, rho_1 kappa) - n pi, zero at mode n, radians.

    frequency : Hz; vertical : k_z, 1/m; number : n, from 1; shapes that broadcast
    """
    limit = 2 * np.pi * frequency * np.sqrt(1 / waveguide.water_speed**2 - 1 / waveguide.bottom_speed**2)
    decay = np.sqrt(np.maximum(limit**2 - vertical**2, 0))
    phase = np.arctan2(waveguide.bottom_density * vertical, waveguide.water_density * decay)
    return vertical * waveguide.depth + phase - number * np.pi


def group_delay_difference(modes, first, second, distance):
    """How much later mode `second` arrives than mode `first`, s, at each frequency.

    first, second : mode numbers from 1; distance : (...), m
    Returns (..., F). Raises ValueError when one of the modes is not trapped at all the frequencies.
    """
    distance = require_positive("distance", distance)
    for number in (first, second):
        require_whole("mode number", number, 1)
        if number > modes.count or np.isnan(modes.group_speed[number - 1]).any():
            raise ValueError(
                f"mode {number} must be trapped, but only {np.sum(np.isfinite(modes.group_speed[:, 0]))} "
                f"modes are trapped at {modes.frequency[0]:g} Hz"
            )
    return distance[..., None] * (1 / modes.group_speed[second - 1] - 1 / modes.group_speed[first - 1])


def mode_strength(modes, source_depth, receiver_depth):
    """How strongly each mode joins a source to a receiver: shape(source) shape(receiver) / (rho sqrt(k)).

    Returns (N, F), 0 where a mode is not trapped. Raises ValueError for depths outside the water.
    """
    require_between("source_depth", source_depth, 0, modes.waveguide.depth)
    require_between("receiver_depth", receiver_depth, 0, modes.waveguide.depth)
    shapes = modes.shape(source_depth) * modes.shape(receiver_depth)
    return np.nan_to_num(shapes / (modes.waveguide.water_density * np.sqrt(modes.wavenumber)))


def pressure(modes, distance, source_depth=3.0, receiver_depth=20.0):
    """Far-field pressure of a source of unit strength, relative to the pressure 1 m from it.

    p = exp(-i pi/4) sqrt(2 pi / r) sum_n strength_n exp(-(alpha_n + i k_n) r), the sum behind Dong et
    al. 2020, eq. 1, with the constants that make the free-field source exp(-i k R) / R.
    distance : (...), m, many wavelengths; depths : m, inside the water
    Returns complex (..., F). Raises ValueError for a distance that is not above 0: through the receiver.
    """
    distance = require_positive("distance", distance)[..., None]
    strength = mode_strength(modes, source_depth, receiver_depth)
    total = sum(strength[n] * np.exp(-_propagation(modes, n) * distance) for n in range(modes.count))
    return np.exp(-0.25j * np.pi) * np.sqrt(2 * np.pi / distance) * total


def array_field(modes, array, distance, bearing, source_depth=3.0, memory=500e6, progress=None):
    """Pressure at every receiver of a horizontal array for every frame of a passing source.

    Each mode crosses the array as a plane wave, r_m = r - x_m cos(bearing), with the amplitude 1/sqrt(r)
    of the centre. Computed in chunks of frames; receiver after receiver by multiplication.
    distance : (K,), m, from the centre; bearing : (K,), radians from the array's axis
    memory : bytes that the result and the work space together may take
    progress : called after each chunk with the fraction that is done, or None
    Returns complex64 (K, elements, F). Raises ValueError when the result alone needs more than `memory`,
    for a distance that is not above 0, and for shapes that differ.
    """
    distance = require_shape("distance", require_positive("distance", distance), (None,))
    bearing = require_shape("bearing", require_finite("bearing", bearing), distance.shape)
    shape = (distance.size, array.elements, modes.frequency.size)
    chunk = _chunk_frames(shape, memory)
    strength = mode_strength(modes, source_depth, array.depth)
    result = np.zeros(shape, dtype=np.complex64)
    for first in range(0, shape[0], chunk):
        rows = slice(first, first + chunk)
        _add_modes(result[rows], modes, array, strength, distance[rows], bearing[rows])
        if progress is not None:
            progress(min(first + chunk, shape[0]) / shape[0])
    return result


def ship_sound(rng, field, noise_power):
    """Give each frame the spectrum of a ship and add the noise of the sea, in place.

    The source has unit strength and random phase in every bin; the noise is white over receivers and bins.
    Frame after frame is drawn, so the first frames of a long scene are those of a short one.
    rng : numpy.random.Generator; field : complex64 (K, elements, F), of a source of unit strength
    noise_power : mean square of the noise at one receiver in one bin, in the unit of |field|^2
    Returns `field`. Raises ValueError for a noise power that is not above 0.
    """
    noise_std = np.float32(np.sqrt(require_positive("noise_power", noise_power) / 2))
    for frame in field:
        draw = rng.standard_normal((2, frame.shape[-1]))
        source = draw[0] + 1j * draw[1]
        frame *= (source / np.abs(source)).astype(np.complex64)
        noise = rng.standard_normal((*frame.shape, 2), dtype=np.float32)
        frame += noise_std * noise.view(np.complex64)[..., 0]
    return field


def beam_sound(rng, clean, snr_db, elements):
    """What a beam hears that follows a ship: the sound at one receiver, with 1 / elements of its noise.

    rng : numpy.random.Generator; clean : complex (K, F), of a source of unit strength, as from `pressure`
    snr_db : signal to noise at one receiver, dB; elements : how many receivers the beam adds up
    Returns complex64 (K, F).
    """
    field = clean[:, None].astype(np.complex64)
    noise_power = np.mean(np.abs(field) ** 2) * power_ratio(-snr_db) / elements
    return ship_sound(rng, field, noise_power)[:, 0]


def _complete_modes(waveguide, frequency, vertical):
    omega = 2 * np.pi * frequency
    water, bottom = omega / waveguide.water_speed, omega / waveguide.bottom_speed
    wavenumber = np.sqrt(water**2 - vertical**2)
    decay = np.sqrt(np.maximum(wavenumber**2 - bottom**2, 0))
    angle = vertical * waveguide.depth
    with np.errstate(divide="ignore"):
        below = np.sin(angle) ** 2 / (2 * waveguide.bottom_density * decay)
    within = (waveguide.depth / 2 - np.sin(2 * angle) / (4 * vertical)) / waveguide.water_density
    amplitude = 1 / np.sqrt(within + below)
    share = below / (within + below)
    speeds = (waveguide.water_speed, waveguide.bottom_speed)
    slowness = omega / wavenumber * ((1 - share) / speeds[0] ** 2 + share / speeds[1] ** 2)
    bottom_loss = waveguide.bottom_attenuation_db / NEPER_IN_DB * frequency / waveguide.bottom_speed
    attenuation = bottom / wavenumber * bottom_loss * share
    return Modes(waveguide, frequency, vertical, decay, wavenumber, attenuation, 1 / slowness, amplitude)


def _add_modes(field, modes, array, strength, distance, bearing):
    distance, along = distance[:, None], np.cos(bearing)[:, None]
    scale = np.exp(-0.25j * np.pi) * np.sqrt(2 * np.pi / distance)
    start = distance - array.positions[0] * along
    for n in range(modes.count):
        trapped = slice(np.argmax(strength[n] != 0), None)
        rate = _propagation(modes, n)[trapped]
        wave = (scale * strength[n, trapped] * np.exp(-rate * start)).astype(np.complex64)
        step = np.exp(rate * array.spacing * along).astype(np.complex64)
        for element in range(array.elements):
            field[:, element, trapped] += wave
            wave *= step


def _propagation(modes, index):
    return np.nan_to_num(modes.attenuation[index] + 1j * modes.wavenumber[index])


def _chunk_frames(shape, memory):
    frames, elements, bins = shape
    result = 8 * frames * elements * bins
    per_frame = 6 * 16 * bins
    if result + per_frame > memory:
        raise ValueError(
            f"memory must be at least {(result + per_frame) / 1e6:.3g} MB for {frames} frames x {elements} "
            f"elements x {bins} frequencies, but {memory / 1e6:g} MB was given"
        )
    return int(np.clip((memory - result) // per_frame, 1, 16))
