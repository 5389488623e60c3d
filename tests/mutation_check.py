"""Break the formulas one by one and see whether the tests notice: python tests/mutation_check.py [MODULE ...]

Each mutant is a mistake that a person could make: a flipped sign, a lost factor, sine for cosine. A copy of
the lab in a temporary folder is changed, and the module's own tests are run on it. Ends with status 1 when a
mutant survives, when a mutant's text is not found, or when the tests fail before anything is broken.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 600  # seconds for one module's tests

MUTANTS = {
    "arguments": [
        ("if not np.all(array > 0):", "if not np.all(array >= 0):"),
        ("if not np.all(array >= 0):", "if not np.all(array > 0):"),
        ("outside = (array < low) | (array > high)", "outside = array < low"),
    ],
    "beamforming": [
        ("return np.exp(1j * phase)", "return np.exp(-1j * phase)"),
        ("np.where(curve < 0, 2 * curve, -np.inf)", "np.where(curve < 0, curve, -np.inf)"),
        ("np.exp(-1j * phase * array.positions[0])", "np.exp(1j * phase * array.positions[0])"),
        ("(array.elements - fitted)", "(array.elements + fitted)"),
        ("+ (frames - 1) / 2", "+ frames / 2"),
        ("np.where(peak == inner, (bearing[1]", "np.where(peak > 0, (bearing[1]"),
    ],
    "bearing_gate": [
        ("target_range - baseline * np.cos(theta))", "target_range + baseline * np.cos(theta))"),
        ("margin = 2 * first_error + 2 * second_error", "margin = first_error + second_error"),
        ("north + scenario.baseline", "north - scenario.baseline"),
        ("np.where(np.sin(left) > 0, up, low)", "np.where(np.sin(left) > 0, low, up)"),
        ("2 * spread**2 * np.log(", "spread**2 * np.log("),
    ],
    "bistatic": [
        ("(2 * (path - baseline * np.cos", "(2 * (path + baseline * np.cos"),
        (
            "(1 + towards_source / sound_speed) / (1 - towards_receiver / sound_speed)",
            "(1 - towards_source / sound_speed) / (1 + towards_receiver / sound_speed)",
        ),
        ("by_delay = sound_speed * (path - distance)", "by_delay = sound_speed * (path + distance)"),
        ("* (1 - along)", "* along"),
        ("np.mean(far**2 - near**2) / 2", "np.mean(far**2 - near**2)"),
        ("return -across / distance[..., None]", "return across / distance[..., None]"),
        ("gain * (to_source + ratio * to_receiver)", "gain * (to_source - ratio * to_receiver)"),
        ("return 3 / (2 * np.pi**2", "return 3 / (4 * np.pi**2"),
    ],
    "checks": [
        ("<= tolerance * abs(expected)", "<= tolerance"),
        ("if answer == expected else", "if answer != expected else"),
        ("return HOLDS if everywhere else CONDITIONAL", "return CONDITIONAL if everywhere else HOLDS"),
    ],
    "course": [
        ("first + np.arctan2(b1", "first - np.arctan2(b1"),
        ("cosine[..., :1] - ratio * cosine", "cosine[..., :1] + ratio * cosine"),
        (
            "(ratio_std * np.sin(angle)) ** 2 + (ratio * bearing_std * np.cos(angle)) ** 2",
            "(ratio_std * np.cos(angle)) ** 2 + (ratio * bearing_std * np.sin(angle)) ** 2",
        ),
        ("[x - smallest * y for", "[x + smallest * y for"),
        ("np.where(along < 0, np.pi, 0.0)", "np.where(along > 0, np.pi, 0.0)"),
        ("cross**2 / (first + 1 / bearing_std**2)", "cross**2 / (first + bearing_std**2)"),
        ("return _products((sine, cosine))", "return _products((cosine, sine))"),
        ("[value - x * y / pivot", "[value + x * y / pivot"),
        ('require_increasing("time", time) - time[0]', 'require_increasing("time", time)'),
    ],
    "delay_tracking": [
        ("np.array([[1.0, -interval / 2]])", "np.array([[1.0, interval / 2]])"),
        ("t**3 / 3", "t**3 / 2"),
        ("return noise_density(pair) / (32 *", "return noise_density(pair) / (16 *"),
        ("/ (4 * np.square(rate))", "/ (2 * np.square(rate))"),
        ("return pair.peak / rate * (1 - ", "return pair.peak / rate * (1 + "),
        ("slow = 8 * pair.centre_frequency", "slow = 4 * pair.centre_frequency"),
        ("return -np.sqrt(longest**2", "return np.sqrt(longest**2"),
        ("(turn + rate + aiding[k])", "(turn + rate - aiding[k])"),
    ],
    "discriminator": [
        ("return 2 * pair.signal_power * (1 + np.sinc", "return 2 * pair.signal_power * (1 - np.sinc"),
        ("own = pair.noise_power**2 + 2 * pair", "own = pair.noise_power**2 + pair"),
        ("return 1 / (4 * self.centre_frequency)", "return 1 / (2 * self.centre_frequency)"),
        ("return 2 / (np.pi**2 *", "return 1 / (np.pi**2 *"),
        ("return -1j * np.divide(", "return 1j * np.divide("),
        ("np.sqrt(power**2 - np.real(", "np.sqrt(power**2 + np.real("),
    ],
    "gmphd": [
        ("weight=(1 - model.detection) * mixture", "weight=model.detection * mixture"),
        ("np.array([self.period**2 / 2, self.period])", "np.array([self.period**2, self.period])"),
        ("-0.5 * (distance +", "-1.0 * (distance +"),
        ("Mixture(model.survival * mixture.weight,", "Mixture(mixture.weight,"),
        ("claimed = measurements.clutter + ", "claimed = "),
        ("covariance[component] - gain @", "covariance[component] + gain @"),
        ("member.covariance + offset[:, :, None] * offset[:, None, :]", "member.covariance"),
    ],
    "metrics": [
        ("- reference + np.pi) %", "+ reference + np.pi) %"),
        ("np.sqrt(2 * require_positive", "np.sqrt(require_positive"),
        ("(cutoff**order / 2 *", "(cutoff**order *"),
        ("settled = np.abs(error) <= threshold", "settled = error <= threshold"),
    ],
    "montecarlo": [
        ("study, i, seeds[i], sizes[i])", "study, i, seeds[0], sizes[i])"),
        ("if attempt == ATTEMPTS:", "if attempt >= 1:"),
        ("_joined([parts[i] for i in range(len(sizes))])", "_joined(list(parts.values()))"),
        ("!= (trials,):", "> (trials,):"),
    ],
    "motion": [
        ("along * cosine - distance * sine", "along * cosine + distance * sine"),
        ("np.sinc(np.diff(angle) / (2 * np.pi))", "np.sinc(np.diff(angle) / np.pi)"),
        ("np.stack([np.cos(north) * turn,", "np.stack([turn,"),
        ("sound_speed * (time - emitted)", "sound_speed * (emitted - time)"),
        ("position + beyond[..., None] *", "position - beyond[..., None] *"),
    ],
    "noise": [
        ("return 10 * np.log10", "return 20 * np.log10"),
        ("/ (2 * np.sqrt(bins))", "/ np.sqrt(2 * bins)"),
        ("- TAPS // 2 + 1", "- TAPS // 2"),
        ("return np.sinc(offset) * window", "return np.sinc(offset)"),
    ],
    "operator_display": [
        ("(before > 0) & (after <= 0)", "(before < 0) & (after >= 0)"),
        ("middle = (time[0] + time[-1]) / 2", "middle = time[0]"),
        ("np.zeros_like(tau12), -tau23", "np.zeros_like(tau12), tau23"),
        ("(1.0 - _within(time, scenario.fade))", "_within(time, scenario.fade)"),
    ],
    "passive_ranging": [
        ("np.asarray(eps) - 2 * displacement_toward", "np.asarray(eps) + 2 * displacement_toward"),
        (
            "result = 1 - (np.cos(triplet.pitch) * np.sin(bearing)) ** 2",
            "result = (np.cos(triplet.pitch) * np.cos(bearing)) ** 2",
        ),
        ("(6 + 2 * ratio) / (2 + ratio)", "(6 + ratio) / (2 + ratio)"),
        ("delay = -np.diff(distance", "delay = np.diff(distance"),
        ("[-cos_roll * sin_pitch, sin_roll,", "[cos_roll * sin_pitch, sin_roll,"),
        ("np.sinc(wavelengths * np.sin(elevation)) ** 2", "np.sinc(wavelengths * np.sin(elevation))"),
    ],
    "surface_motion": [
        ("depth * np.tan(", "depth * np.sin("),
        ("position[..., None, :] / distance**2", "position[..., None, :] / distance"),
        ("return time - slant_range(", "return time + slant_range("),
        ("spread[..., 1, 1]) / 2", "spread[..., 1, 1])"),
        ("y * cosine - x * sine", "y * cosine + x * sine"),
        ("inside[1:] -= total", "inside[1:] += total"),
    ],
    "vector_sensor": [
        ("np.arctan2(np.hypot(x, y), z)", "np.arctan2(z, np.hypot(x, y))"),
        ("(1 + 1 / snr) / (2 * time_bandwidth)", "(1 + 1 / snr) / time_bandwidth"),
        ("gain = 1 + 1 / ratio", "gain = 1 + ratio"),
        ("(16 * sigma**2", "(8 * sigma**2"),
        (
            "spreading = closest_approach(scenario).slant_range / heard.slant_range",
            "spreading = heard.slant_range / closest_approach(scenario).slant_range",
        ),
        (".slant_range / distance) ** 2", ".slant_range / distance)"),
        ('"sn3d": ((0, 3, 1, 2)', '"sn3d": ((0, 1, 2, 3)'),
    ],
    "warping": [
        ("** (-(beta + 1) / 2)", "** (-(beta + 1))"),
        ("source = constant * warped**-beta", "source = constant / warped"),
        ("np.mean(delay[..., :reference]", "np.sum(delay[..., :reference]"),
        ("total[..., frames - 1 :, :] / frames", "total[..., frames - 1 :, :] / (frames + 1)"),
        ("[:, None] ** beta", "[:, None] ** -beta"),
    ],
    "waveguide": [
        ("(np.asarray(number) - 0.5)", "(np.asarray(number) - 1.0)"),
        (
            "np.arctan2(waveguide.bottom_density * vertical, waveguide.water_density * decay)",
            "np.arctan2(waveguide.water_density * vertical, waveguide.bottom_density * decay)",
        ),
        ("waveguide.depth / 2 - np.sin(2 * angle)", "waveguide.depth / 2 + np.sin(2 * angle)"),
        ("bottom_loss * share", "bottom_loss"),
        ("distance - array.positions[0] * along", "distance + array.positions[0] * along"),
        ("np.sqrt(2 * np.pi / distance) * total", "np.sqrt(np.pi / distance) * total"),
        ("power_ratio(-snr_db) / elements", "power_ratio(-snr_db)"),
    ],
}


def main(modules):
    unknown = sorted(set(modules) - set(MUTANTS))
    if unknown:
        sys.exit(f"no mutants of: {', '.join(unknown)}; choose from {', '.join(MUTANTS)}")
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        skip = shutil.ignore_patterns("__pycache__", ".*", "*.ipynb")
        for part in ("labsim", "tests", "notebooks"):
            shutil.copytree(ROOT / part, copy / part, ignore=skip)
        for part in ("pyproject.toml", "README.md"):
            shutil.copy(ROOT / part, copy)
        for module in modules or MUTANTS:
            failures += check_module(copy, module)
    print(f"{failures} to look at" if failures else "every mutant was caught")
    return 1 if failures else 0


def check_module(copy, module):
    """Report on each mutant of a module and return how many are not as they should be."""
    path = copy / "labsim" / f"{module}.py"
    whole = path.read_text(encoding="utf-8")
    failure = failed(copy, module)
    if failure:
        print(f"{module}: its tests fail before anything is broken:\n{failure}", flush=True)
        return 1
    failures = 0
    for number, (old, new) in enumerate(MUTANTS[module], 1):
        if whole.count(old) != 1:
            result = f"NOT FOUND ONCE, but {whole.count(old)} times"
        else:
            path.write_text(whole.replace(old, new), encoding="utf-8")
            result = "caught" if failed(copy, module) else "SURVIVED"
        failures += result != "caught"
        print(f"{module} {number}: {result}: {old}  ->  {new}", flush=True)
    path.write_text(whole, encoding="utf-8")
    return failures


def failed(copy, module):
    """The end of pytest's report where a module's tests fail on the copy, or an empty text."""
    environment = os.environ | {"PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
    tests = str(copy / "tests" / f"test_{module}.py")
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-o", "addopts=", "-p", "no:cacheprovider", tests]
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment, capture_output=True, text=True, timeout=LIMIT
        )
    except subprocess.TimeoutExpired:
        return f"no end within {LIMIT} s"
    return (done.stdout[-1000:] or "no report") if done.returncode else ""


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
