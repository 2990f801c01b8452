"""An artefact of known size in the scan: what it says of the instrument's scale, and of a layer on all surfaces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.comparison.stated import kept
from gearwear.design.pair import Design
from gearwear.design.quantity import at_least
from gearwear.design.scan_spec import Artefact, DatumSpec, ScannerSpec
from gearwear.errors import InputError
from gearwear.robust import median_scale
from gearwear.scan.types import Scan

REACH = 0.75
"""Of the diameter, from the stated centre: what lies nearer is the artefact's."""
LEAST_POINTS = 200
CLIPPED = 4.0
"""Robust standard deviations beyond which a point is none of the artefact: its stand, a stray."""
PASSES = 4
LIMIT_STDS = 3.0
"""Standard deviations that the scale may still be off by, once it is calibrated."""
WORST_FIT = 0.02
"""Of the diameter: points that scatter more about the best sphere or cylinder are not of one."""
WORST_SCALE = 0.01
"""Relative error of scale that no calibrated instrument has: the stated diameter is another's. A larger stated limit admits more."""
MOST_LOSS = 5.0
"""By how much the scale may be less sure for a layer fitted beside it; two of nearly one size tell neither."""


@dataclass(frozen=True, slots=True)
class SeenArtefact:
    """An artefact as the scan shows it.

    Parameters
    ----------
    artefact : Artefact
    diameter, std : float
        As measured, and its standard deviation, mm.
    points : int
        In use.
    """

    artefact: Artefact
    diameter: float
    std: float
    points: int

    @property
    def excess(self) -> float:
        """Measured less calibrated, mm."""
        return self.diameter - self.artefact.diameter

    @property
    def excess_std(self) -> float:
        """mm."""
        return math.hypot(self.std, self.artefact.std)


def calibrated(scans: Sequence[Scan], design: Design) -> tuple[tuple[Scan, ...], Design]:
    """The scans in the scale of their artefacts and without them; the design with what is still unsure of the scale.

    Parameters
    ----------
    scans : sequence of Scan
        In one frame of coordinates.
    design : Design
        Its datum names the artefacts.

    Raises
    ------
    InputError
        If an artefact is not where it is said to be, or not of the size.

    Notes
    -----
    A diameter d reads ``d (1 + s) ± 2 o``: a scale s, and a layer o on every surface, outwards on spheres and cylinders, inwards in rings.
    One artefact tells s where there is no layer; two of other sizes or kinds tell both, by weighted least squares, where that costs
    the scale no more than `MOST_LOSS` of its certainty. The layer is told and not taken off: the closed loop finds it on the gear as a coat.
    """
    datum = design.datum
    if not datum.artefacts:
        return tuple(scans), design
    seen = [see(scans, artefact) for artefact in datum.artefacts]
    scale, std, said = _scale(seen)
    _check_scale(seen, scale, std, max(WORST_SCALE, design.scanner.scale_limit or 0.0))
    near = [_near(scan.points, datum.artefacts) for scan in scans]
    rest = tuple(kept(scan, ~mask, "artefact") for scan, mask in zip(scans, near, strict=True))
    scaled = tuple(replace(scan, points=scan.points / (1.0 + scale)) for scan in rest)
    scanner: ScannerSpec = replace(design.scanner, scale_limit=LIMIT_STDS * std, scale_std=std)
    corrected: DatumSpec = replace(datum, calibration=said)
    return scaled, replace(design, scanner=scanner, datum=corrected)


def see(scans: Sequence[Scan], artefact: Artefact) -> SeenArtefact:
    """Fit a sphere or cylinder of free size to the points near the stated centre.

    Raises
    ------
    InputError
        If too few points lie there, or they are none of its kind.
    """
    points = np.concatenate([scan.points[_near(scan.points, (artefact,))] for scan in scans])
    place = f"[datum] artefact: a {artefact.kind} of {artefact.diameter:g} mm at {list(artefact.centre)}"
    if len(points) < LEAST_POINTS:
        raise InputError(f"{place}: {len(points)} points lie there, at least {LEAST_POINTS} are needed; check centre_mm")
    starts = [np.array([*artefact.centre, 0.5 * artefact.diameter])]
    if artefact.kind != "sphere":
        starts = [np.array([*artefact.centre, 0.5 * artefact.diameter, *axis]) for axis in np.eye(3)]
    fits = [_fit(points, start) for start in starts]
    best, use, rest = min(fits, key=lambda fit: float(np.median(np.abs(fit[2]))))
    spread = float(np.sqrt((rest[use] ** 2).sum() / max(int(use.sum()) - len(best), 1)))
    if spread > WORST_FIT * artefact.diameter or use.sum() < LEAST_POINTS:
        raise InputError(f"{place}: what lies there is no {artefact.kind} (off by {spread:.2g} mm); check kind and centre_mm")
    jacobian = _slopes(points[use], best)
    variance = spread**2 * float(np.linalg.pinv(jacobian.T @ jacobian)[3, 3])
    return SeenArtefact(artefact, 2.0 * abs(float(best[3])), 2.0 * math.sqrt(variance), int(use.sum()))


def _near(points: Floats, artefacts: Sequence[Artefact]) -> Bools:
    near = np.zeros(len(points), dtype=bool)
    for artefact in artefacts:
        near |= np.linalg.norm(points - np.array(artefact.centre), axis=1) < REACH * artefact.diameter
    return near


def _fit(points: Floats, start: Floats) -> tuple[Floats, Bools, Floats]:
    """Parameters (centre, radius, and of a cylinder its axis), the points in use and all residuals, mm."""
    from scipy.optimize import least_squares  # few scans hold an artefact

    use, solution = np.ones(len(points), dtype=bool), start
    rest = _residuals(points, start)
    for _ in range(PASSES):
        solution = least_squares(
            lambda x, p=points[use]: _residuals(p, x), solution, x_scale="jac", loss="soft_l1", f_scale=0.02
        ).x
        rest = _residuals(points, solution)
        middle, spread = median_scale(rest)
        use = np.abs(rest - middle) <= CLIPPED * max(spread, 1e-6)
    if not use.any():
        return solution, use, rest
    solution = least_squares(lambda x: _residuals(points[use], x), solution, x_scale="jac").x
    return solution, use, _residuals(points, solution)


def _residuals(points: Floats, parameters: Floats) -> Floats:
    away = points - parameters[:3]
    if len(parameters) > 4:
        axis = parameters[4:] / np.linalg.norm(parameters[4:])
        away = away - (away @ axis)[:, None] * axis
    return np.asarray(np.linalg.norm(away, axis=1) - parameters[3], dtype=np.float64)


def _slopes(points: Floats, parameters: Floats) -> Floats:
    step = 1e-6
    moved = [
        _residuals(points, parameters + step * axis) - _residuals(points, parameters - step * axis)
        for axis in np.eye(len(parameters))
    ]
    return np.column_stack(moved) / (2.0 * step)


def _scale(seen: Sequence[SeenArtefact]) -> tuple[float, float, tuple[str, ...]]:
    """Relative error of scale, its standard deviation, and what is said of it."""
    columns = np.array([[fit.artefact.diameter, -2.0 if fit.artefact.kind == "ring" else 2.0] for fit in seen])
    excess = np.array([fit.excess for fit in seen])
    weight = 1.0 / np.array([fit.excess_std for fit in seen])
    alone, with_layer = columns[:, :1] * weight[:, None], columns * weight[:, None]
    std_alone = 1.0 / math.sqrt(float((alone**2).sum()))
    both = len(seen) > 1 and _scale_std(with_layer) <= MOST_LOSS * std_alone
    used = with_layer if both else alone
    covariance = np.linalg.inv(used.T @ used)
    solution = covariance @ used.T @ (excess * weight)
    std = math.sqrt(float(covariance[0, 0]))
    sizes = ", ".join(f"{fit.artefact.kind} {fit.artefact.diameter:g} mm seen as {fit.diameter:.4f}" for fit in seen)
    said = f"lengths are brought to the scale of the artefacts ({sizes}): {-1e6 * solution[0]:+z.0f} ± {1e6 * std:.0f} ppm"
    if both:
        layer = 1e3 * float(solution[1])
        said += f"; they show a layer of {layer:+z.1f} ± {1e3 * math.sqrt(float(covariance[1, 1])):.1f} µm on their surfaces, which is not taken off"
    elif len(seen) > 1:
        said += "; they are too alike in size to tell a layer on their surfaces from the scale: none is assumed"
    else:
        said += "; one size cannot tell a layer on its surface from the scale: none is assumed"
    return float(solution[0]), std, (said.replace("-", "−"),)


def _scale_std(columns: Floats) -> float:
    """Standard deviation of the scale with the layer free: what of its column the other does not explain."""
    scale, layer = columns.T
    left = scale - layer * float(scale @ layer) / float(layer @ layer)
    size = float(np.linalg.norm(left))
    return 1.0 / size if size > 0.0 else math.inf


def _check_scale(seen: Sequence[SeenArtefact], scale: float, std: float, limit: float) -> None:
    worst = max(seen, key=lambda fit: abs(fit.excess) / fit.artefact.diameter)
    sight = f"[datum] artefact: a {worst.artefact.kind} of {worst.artefact.diameter:g} mm is seen as {worst.diameter:.4f} mm"
    off = max(abs(scale), abs(worst.excess) / worst.artefact.diameter)
    if off > limit:
        raise InputError(
            f"{sight}, {at_least(1e6 * off, 0)} ppm off where up to {1e6 * limit:.0f} are expected; check diameter_mm, or state [scanner] scale_ppm_max"
        )
    if LIMIT_STDS * std > limit:
        raise InputError(
            f"{sight}, and tells the scale to ± {at_least(1e6 * std, 0)} ppm alone; a smaller std_um or more points would be right"
        )
