"""The Gaussian-mixture PHD filter: how many targets are there, and where, from detections full of clutter.

The filter carries one density over the plane whose integral over any region is the expected number of targets
in it; as a Gaussian mixture, its weights sum to the expected number in all. Each scan it is moved, thinned by
what was missed and raised where something was heard (Vo & Ma 2006, the filter that Ma et al. 2023 use).
A component's state is [x, vx, y, vy]; motion is nearly constant velocity, Ma et al. 2023, eq. 8.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import linear_sum_assignment

from labsim.arguments import (
    require_between,
    require_finite,
    require_not_negative,
    require_positive,
    require_scalar,
    require_shape,
    require_whole,
)
from labsim.metrics import angle_difference

STATE = 4


@dataclass(frozen=True)
class PhdModel:
    """What the filter believes: motion, births, detection, and how it keeps the mixture small.

    Lengths in m, times in s; `gate` and `merge_within` are squared Mahalanobis distances.
    """

    period: float = 20.0
    acceleration: float = 0.02
    survival: float = 0.99
    detection: float = 0.9
    birth_sites: tuple = ((-6_000.0, 5_000.0), (0.0, 8_000.0), (6_000.0, 6_000.0), (3_000.0, 2_500.0))
    birth_weight: float = 0.03
    birth_spread: float = 300.0
    birth_speed: float = 3.0
    gate: float = 20.0
    prune_below: float = 1e-5
    merge_within: float = 4.0
    most: int = 100
    report_above: float = 0.5
    confirm_after: int = 2
    coast_misses: int = 2
    apart: float = 200.0

    def __post_init__(self):
        for name in ("survival", "detection"):
            require_between(name, require_scalar(name, getattr(self, name)), 0, 1)
        for name in ("period", "birth_spread", "birth_speed", "gate"):
            require_positive(name, require_scalar(name, getattr(self, name)))
        for name in ("acceleration", "birth_weight", "prune_below", "merge_within", "report_above", "apart"):
            require_not_negative(name, require_scalar(name, getattr(self, name)))
        for name, least in (("most", 1), ("confirm_after", 1), ("coast_misses", 0)):
            require_whole(name, getattr(self, name), least)
        require_finite("birth_sites", self.birth_sites)

    @cached_property
    def transition(self):
        """F, (4, 4), constant velocity over one period (Ma et al. 2023, eq. 8)."""
        return np.kron(np.eye(2), [[1.0, self.period], [0.0, 1.0]])

    @cached_property
    def process(self):
        """G Q G', (4, 4): independent accelerations along x and y, constant within a period; of rank 2."""
        push = self.acceleration * np.array([self.period**2 / 2, self.period])
        return np.kron(np.eye(2), np.outer(push, push))

    @cached_property
    def births(self):
        """The mixture of targets that may appear in one scan, one component a site, at rest."""
        sites = np.reshape(np.asarray(self.birth_sites, dtype=float), (-1, 2))
        mean = np.zeros((len(sites), STATE))
        mean[:, 0::2] = sites
        spread = np.diag([self.birth_spread**2, self.birth_speed**2] * 2)
        return make_mixture(np.full(len(sites), self.birth_weight), mean, np.tile(spread, (len(sites), 1, 1)))


@dataclass(frozen=True)
class Mixture:
    """A Gaussian mixture as three arrays, and a label that tells which component came from which.

    weight : (J,), expected number of targets; mean : (J, 4); covariance : (J, 4, 4); label : (J,) of int
    """

    weight: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray
    label: np.ndarray

    def __len__(self):
        return len(self.weight)

    def take(self, chosen):
        """The components of a mask or of indices."""
        return Mixture(self.weight[chosen], self.mean[chosen], self.covariance[chosen], self.label[chosen])


@dataclass(frozen=True)
class Measurements:
    """One scan as a filter takes it.

    value : (M, d), the first two coordinates must locate a target; covariance : (M, d, d)
    clutter : (M,), expected clutter per scan and unit of measurement space, at each measurement
    angle_first : whether the first coordinate is an angle, radians
    """

    value: np.ndarray
    covariance: np.ndarray
    clutter: np.ndarray
    angle_first: bool = False

    def __post_init__(self):
        value = require_shape("value", require_finite("value", self.value), (None, None))
        count, size = value.shape[-2:]
        require_whole("coordinates of value", size, 2)
        require_covariance("covariance", self.covariance, count, size)
        require_shape("clutter", require_not_negative("clutter", self.clutter), (count,))

    def __len__(self):
        return len(self.value)


@dataclass(frozen=True)
class Tracker:
    """A nearest-neighbour Kalman tracker, the baseline: one state a track, one measurement a track and scan.

    A track is reported once it has `confirm_hits` measurements; it is dropped after `tentative_misses` misses
    in a row before that, and `confirmed_misses` after. It shares motion and birth speed with `model`, and is
    not told the birth sites.
    """

    model: PhdModel = PhdModel()
    gate: float = 9.0
    confirm_hits: int = 3
    tentative_misses: int = 1
    confirmed_misses: int = 3

    def __post_init__(self):
        require_positive("gate", require_scalar("gate", self.gate))
        for name in ("confirm_hits", "tentative_misses", "confirmed_misses"):
            require_whole(name, getattr(self, name), 1)


@dataclass(frozen=True)
class Run:
    """A filter's answer for every scan: reported states, lists of (n, 4) arrays, and the mixture's figures.

    weight_sum, components : (scans,), expected number of targets and components kept
    """

    reported: list
    weight_sum: np.ndarray
    components: np.ndarray


def make_mixture(weight, mean, covariance):
    """A checked Mixture, labelled 0, 1, ...

    Raises ValueError for shapes that differ, negative weights, bad covariances.
    """
    weight = require_shape("weight", require_not_negative("weight", weight), (None,))
    mean = require_shape("mean", require_finite("mean", mean), (weight.size, STATE))
    covariance = require_covariance("covariance", covariance, weight.size, STATE)
    return Mixture(weight, mean, covariance, np.arange(weight.size))


def empty_mixture():
    """A mixture of no components: nobody expected anywhere."""
    return Mixture(np.zeros(0), np.zeros((0, STATE)), np.zeros((0, STATE, STATE)), np.zeros(0, dtype=int))


def predict(mixture, model):
    """Move every component one period on: w P_S, F m, F P F' + G Q G'."""
    motion = model.transition
    covariance = motion @ mixture.covariance @ motion.T + model.process
    return Mixture(model.survival * mixture.weight, mixture.mean @ motion.T, covariance, mixture.label)


def add_births(mixture, model, first_label=0):
    """Append the model's births, labelled first_label, first_label + 1, ..."""
    births = model.births
    return join(mixture, replace(births, label=first_label + np.arange(len(births))))


def join(*mixtures):
    """All components of several mixtures in one."""
    parts = zip(*((m.weight, m.mean, m.covariance, m.label) for m in mixtures), strict=True)
    return Mixture(*(np.concatenate(part) for part in parts))


def observe_position(mean):
    """Predicted measurement and its derivatives where x and y are measured: (J, 2) and (J, 2, 4)."""
    rows = np.zeros((2, STATE))
    rows[0, 0] = rows[1, 2] = 1.0
    return mean[:, 0::2], np.broadcast_to(rows, (len(mean), 2, STATE))


def update(mixture, measurements, observe, model):
    """One scan heard: every component is missed, and is paired with every measurement in its gate.

    observe : function of means (J, 4) that returns predictions (J, d) and their derivatives (J, d, 4)
    Returns the mixture of missed components, (1 - P_D) w, followed by the detected pairs, whose weights
    P_D w q / (clutter + sum over components of P_D w q) share each measurement between targets and clutter.
    """
    missed = replace(mixture, weight=(1 - model.detection) * mixture.weight)
    if len(mixture) == 0 or len(measurements) == 0 or model.detection == 0:
        return missed
    component, measurement, innovation, jacobian = gated_pairs(mixture, measurements, observe, model.gate)
    noise = measurements.covariance[measurement]
    mean, covariance, log_likelihood = kalman_update(
        mixture.mean, mixture.covariance, component, innovation, jacobian, noise
    )
    weight = model.detection * mixture.weight[component] * np.exp(log_likelihood)
    claimed = measurements.clutter + np.bincount(measurement, weight, len(measurements))
    share = weight / np.maximum(claimed[measurement], np.finfo(float).tiny)
    return join(missed, Mixture(share, mean, covariance, mixture.label[component]))


def gated_pairs(mixture, measurements, observe, gate):
    """The pairs of component and measurement whose first two coordinates agree within the gate.

    Returns (component (n,), measurement (n,), innovation (n, d), jacobian (J, d, 4)).
    """
    predicted, jacobian = observe(mixture.mean)
    innovation = measurements.value[None] - predicted[:, None]
    if measurements.angle_first:
        innovation[..., 0] = angle_difference(measurements.value[:, 0], predicted[:, None, 0])
    plane = jacobian[:, :2]
    own = plane @ mixture.covariance @ plane.swapaxes(1, 2)
    spread = own[:, None] + measurements.covariance[:, :2, :2]
    s00, s01, s11 = spread[..., 0, 0], spread[..., 0, 1], spread[..., 1, 1]
    e0, e1 = innovation[..., 0], innovation[..., 1]
    inside = s11 * e0 * e0 - 2 * s01 * e0 * e1 + s00 * e1 * e1 < gate * (s00 * s11 - s01 * s01)
    component, measurement = np.nonzero(inside)
    return component, measurement, innovation[component, measurement], jacobian


def kalman_update(mean, covariance, component, innovation, jacobian, noise):
    """Kalman update of n pairs of a component and a measurement.

    mean : (J, 4); covariance : (J, 4, 4); component : (n,), the component of each pair
    innovation : (n, d); jacobian : (J, d, 4); noise : (n, d, d)
    Returns (mean (n, 4), covariance (n, 4, 4), log likelihood of the innovation (n,)). Covariances are made
    symmetric: the rounding errors of P - K S K' grow from scan to scan, to a tenth of P in fifty.
    """
    cross = covariance @ jacobian.swapaxes(1, 2)
    spread = (jacobian @ cross)[component] + noise
    inverse = np.linalg.inv(spread)
    cross = cross[component]
    gain = cross @ inverse
    distance = np.einsum("ni,nij,nj->n", innovation, inverse, innovation)
    size = innovation.shape[1]
    log_likelihood = -0.5 * (distance + np.log(np.linalg.det(spread)) + size * np.log(2 * np.pi))
    updated = mean[component] + np.einsum("nij,nj->ni", gain, innovation)
    left = covariance[component] - gain @ cross.swapaxes(1, 2)
    return updated, (left + left.swapaxes(1, 2)) / 2, log_likelihood


def prune(mixture, below):
    """Drop components lighter than `below`."""
    return mixture.take(mixture.weight >= below)


def merge(mixture, within):
    """Replace each cluster of near components by one Gaussian with its weight, mean and covariance.

    within : squared Mahalanobis distance, in each member's own covariance, to the heaviest member
    Clusters form greedily from the heaviest component on; each keeps the label of its heaviest member.
    """
    if len(mixture) < 2:
        return mixture
    ordered = mixture.take(np.argsort(-mixture.weight, kind="stable"))
    heads, cluster = _clusters(_squared_distances(ordered) <= within)
    if heads.size == len(ordered):
        return ordered
    order = np.argsort(cluster, kind="stable")
    member, cluster = ordered.take(order), cluster[order]
    first = np.searchsorted(cluster, np.arange(heads.size))
    weight = np.add.reduceat(member.weight, first)
    fraction = member.weight / weight[cluster]
    mean = np.add.reduceat(fraction[:, None] * member.mean, first)
    offset = member.mean - mean[cluster]
    spread = member.covariance + offset[:, :, None] * offset[:, None, :]
    covariance = np.add.reduceat(fraction[:, None, None] * spread, first)
    return Mixture(weight, mean, covariance, ordered.label[heads])


def cap(mixture, most):
    """Keep the `most` heaviest components."""
    most = require_whole("most", most)
    if len(mixture) <= most:
        return mixture
    return mixture.take(np.argsort(-mixture.weight, kind="stable")[:most])


def extract(mixture, above=0.5):
    """Reported targets: every component heavier than `above`, round(w) times.

    Returns (states (n, 4), labels (n,)).
    """
    heavy = np.flatnonzero(mixture.weight > above)
    copies = np.maximum(np.round(mixture.weight[heavy]), 1).astype(int)
    chosen = np.repeat(heavy, copies)
    return mixture.mean[chosen], mixture.label[chosen]


def coast(mixture, model, states, labels, times_reported):
    """Add to a report the known targets that were only missed.

    One missed detection multiplies a weight by about P_S (1 - P_D), a tenth, and the plain report drops the
    target. A label reported in `confirm_after` scans or more is still reported through `coast_misses` misses,
    while its weight exceeds (P_S (1 - P_D))^coast_misses / 2, unless within `apart` of another report.
    times_reported : dict, scans in which each label was reported; states, labels : from `extract`
    Returns (states, labels) with the remembered targets appended.
    """
    least = 0.5 * (model.survival * (1 - model.detection)) ** model.coast_misses
    reported = set(labels.tolist())
    for index in np.argsort(-mixture.weight, kind="stable")[: np.count_nonzero(mixture.weight > least)]:
        label = int(mixture.label[index])
        if label in reported or times_reported.get(label, 0) < model.confirm_after:
            continue
        gap = np.linalg.norm(states[:, 0::2] - mixture.mean[index, 0::2], axis=1)
        if np.all(gap > model.apart):
            states = np.vstack([states, mixture.mean[index]])
            labels = np.append(labels, label)
            reported.add(label)
    return states, labels


def step(mixture, measurements, observe, model, first_label=0):
    """One scan of the filter: predict, birth, update, prune, merge, cap.

    Merging costs the square of the number of components: no more than 20 times the cap enter it.
    """
    expected = add_births(predict(mixture, model), model, first_label)
    heard = update(expected, measurements, observe, model)
    kept = cap(prune(heard, model.prune_below), 20 * model.most)
    return cap(merge(kept, model.merge_within), model.most)


def run_filter(scans, observe, model, coasting=True):
    """The filter over a list of Measurements, from an empty mixture. Returns a Run."""
    mixture, times_reported, reported, figures = empty_mixture(), {}, [], []
    for number, measurements in enumerate(scans):
        mixture = step(mixture, measurements, observe, model, number * len(model.births))
        states, labels = extract(mixture, model.report_above)
        if coasting:
            states, labels = coast(mixture, model, states, labels, times_reported)
        for label in set(labels.tolist()):
            times_reported[label] = times_reported.get(label, 0) + 1
        reported.append(states)
        figures.append((mixture.weight.sum(), len(mixture)))
    weight_sum, components = np.reshape(figures, (-1, 2)).T
    return Run(reported, weight_sum, components.astype(int))


def run_tracker(scans, tracker):
    """The nearest-neighbour tracker over a list of Measurements of x and y.

    Returns a Run whose weight_sum counts the confirmed tracks and whose components count all.
    """
    tracks, hits, misses = empty_mixture(), np.zeros(0, dtype=int), np.zeros(0, dtype=int)
    reported, figures = [], []
    for measurements in scans:
        tracks, paired, taken = _pair_and_update(predict(tracks, tracker.model), measurements, tracker.gate)
        hits, misses = hits + paired, np.where(paired, 0, misses + 1)
        confirmed = hits >= tracker.confirm_hits
        keep = misses < np.where(confirmed, tracker.confirmed_misses, tracker.tentative_misses)
        new = _new_tracks(measurements, ~taken, tracker.model)
        tracks = join(tracks.take(keep), new)
        hits = np.concatenate([hits[keep], np.ones(len(new), dtype=int)])
        misses = np.concatenate([misses[keep], np.zeros(len(new), dtype=int)])
        reported.append(tracks.mean[hits >= tracker.confirm_hits])
        figures.append((np.count_nonzero(hits >= tracker.confirm_hits), len(tracks)))
    weight_sum, components = np.reshape(figures, (-1, 2)).T
    return Run(reported, weight_sum.astype(float), components)


def require_covariance(name, value, count, size):
    """Return (count, size, size) covariances; raise ValueError unless all are symmetric positive definite."""
    value = require_shape(name, require_finite(name, value), (count, size, size))
    if value.ndim != 3:
        raise ValueError(f"{name} must have shape ({count}, {size}, {size}), but {value.shape} was given")
    scale = np.abs(value).max(axis=(1, 2), initial=0.0)
    if np.any(np.abs(value - value.swapaxes(1, 2)).max(axis=(1, 2), initial=0.0) > 1e-8 * scale):
        raise ValueError(f"{name} must be symmetric, but one is not")
    try:
        np.linalg.cholesky(value)
    except np.linalg.LinAlgError:
        raise ValueError(f"{name} must be positive definite, but one is not") from None
    return value


def _pair_and_update(tracks, measurements, gate):
    paired, taken = np.zeros(len(tracks), dtype=bool), np.zeros(len(measurements), dtype=bool)
    if len(tracks) == 0 or len(measurements) == 0:
        return tracks, paired, taken
    track, measurement, innovation, jacobian = gated_pairs(tracks, measurements, observe_position, gate)
    mean, covariance, log_likelihood = kalman_update(
        tracks.mean, tracks.covariance, track, innovation, jacobian, measurements.covariance[measurement]
    )
    cost = np.full((len(tracks), len(measurements)), 1e6)
    cost[track, measurement] = -log_likelihood
    pair = np.full(cost.shape, -1)
    pair[track, measurement] = np.arange(len(track))
    row, column = linear_sum_assignment(cost)
    good = pair[row, column] >= 0
    row, column, chosen = row[good], column[good], pair[row, column][good]
    paired[row], taken[column] = True, True
    new_mean, new_covariance = tracks.mean.copy(), tracks.covariance.copy()
    new_mean[row], new_covariance[row] = mean[chosen], covariance[chosen]
    return replace(tracks, mean=new_mean, covariance=new_covariance), paired, taken


def _new_tracks(measurements, free, model):
    value, noise = measurements.value[free], measurements.covariance[free]
    mean, covariance = np.zeros((len(value), STATE)), np.zeros((len(value), STATE, STATE))
    mean[:, 0::2] = value
    covariance[:, 0::2, 0::2] = noise
    covariance[:, 1, 1] = covariance[:, 3, 3] = model.birth_speed**2
    return Mixture(np.ones(len(value)), mean, covariance, np.zeros(len(value), dtype=int))


def _squared_distances(mixture):
    """Squared Mahalanobis distance of mean i from mean j in the covariance of j, (J, J).

    With A_j the inverse of covariance j, it is x_i' A_j x_i - 2 x_i' A_j x_j + x_j' A_j x_j:
    a row made of x_i times a column made of x_j and A_j, so that one matrix product gives all pairs.
    """
    count = len(mixture)
    inverse = np.linalg.inv(mixture.covariance)
    x = mixture.mean - mixture.mean.mean(axis=0)
    turned = np.einsum("jkl,jl->jk", inverse, x)
    constant = np.einsum("jk,jk->j", x, turned)[:, None]
    squares = (x[:, :, None] * x[:, None, :]).reshape(count, -1)
    rows = np.concatenate([squares, -2 * x, np.ones((count, 1))], axis=1)
    columns = np.concatenate([inverse.reshape(count, -1), turned, constant], axis=1)
    return rows @ columns.T


def _clusters(near):
    """Clusters of components ordered by weight: the first that is still free takes all free ones near it.

    near : (J, J) of bool, whether component j is near component i in the covariance of j
    Returns (heads (K,), cluster (J,)): the index of each cluster's first, and the cluster of each component.
    """
    np.fill_diagonal(near, True)
    alone = (np.count_nonzero(near, axis=0) == 1) & (np.count_nonzero(near, axis=1) == 1)
    head = np.where(alone, np.arange(len(near)), -1)
    for index in np.flatnonzero(~alone):
        if head[index] < 0:
            head[near[index] & (head < 0)] = index
    return np.unique(head, return_inverse=True)
