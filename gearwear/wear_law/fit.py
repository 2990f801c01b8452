"""The wear law fitted to the measured profile of worn flanks, with its uncertainty, and what part of the wear it explains.

A fit says what a profile is consistent with, not what made it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.card import Card, CardRow, measured
from gearwear.design.gear import Gear
from gearwear.design.given import check_choice, check_number, check_within, real_array
from gearwear.errors import InputError, check_kind
from gearwear.meshing.path import PathOfContact, path_of_contact
from gearwear.threads import on_one_thread
from gearwear.wear_law.archard import TERMS, LoadSharing, law_over, law_terms
from gearwear.wear_law.non_negative import LEAST_STD, error_size, fitted, profile_covariance

ALIKE_CHI_SQUARE = 4.0
"""Difference of χ², in units of χ² per degree of freedom where that is above 1, below which models cannot be told apart."""

LEAST_PART = 0.005
"""Least part of the law's depth that is put into words."""
LEAST_ON_PATH = 0.9
"""Least part of the stretch that a depth is a mean over that must lie on the path of contact."""
_LEAST_POINTS = 8
_LIKE_COEFFICIENTS = 0.05
"""Relative difference of the coefficient over the whole path and in single contact that is not worth a word."""
_MILD_WEAR_DEPTH = 0.010
"""mm; depth above which contact leaves the line of action of the unworn flanks, on which K is reckoned."""


def check_confidence(confidence: float) -> None:
    """Refuse a confidence that no interval has: at 1 it has no end, and below 0 its limits change places."""
    check_number("confidence", confidence, "")
    if not (
        confidence > 0.0 and 0.5 + 0.5 * confidence < 1.0
    ):  # as it is used: so near to 1 that it rounds to it; refuses NaN too
        raise InputError(f"confidence {confidence:g}: above 0 and below 1 would be right, such as 0.95")


@dataclass(frozen=True, slots=True)
class SingleContact:
    """``depth = A |K| + B`` on the stretch where one pair carries alone, mm, with standard deviations; nan where too few points lie there.

    Parameters
    ----------
    sliding, sliding_std : float
        A: k w times the cycles run, whatever the load sharing was elsewhere.
    uniform, uniform_std : float
        B.
    """

    sliding: float
    sliding_std: float
    uniform: float
    uniform_std: float


@dataclass(frozen=True, slots=True, repr=False)
class WearFit(Card):
    """``depth(L) = A · share(L) · |K(L)| + B + C · [one pair carries alone]``, all of A, B, C at least 0.

    Parameters
    ----------
    gear, mate : Gear
        The worn gear and the other.
    centre_distance : float
        mm.
    sharing : LoadSharing
        The load sharing of the first term.
    roll, depth : (n,) float
        What was fitted, within the path of contact: length of roll and mean depth, mm.
    teeth : (k, n) float
        Depth of each of the teeth, mm; of one profile that alone.
    errors : (n, n) float
        Covariance of the errors of `depth`, mm².
    known : bool
        Whether `errors` came with the profile; else its size is that of what the best model leaves.
    basis : (n, 3) float
        The terms at coefficient 1, in the order of `TERMS`.
    coefficients : (3,) float
        A, B, C in mm. A is k w times the cycles run.
    covariance : (3, 3) float
        mm², of the fit without bounds, times χ² per degree of freedom where that is above 1. So near a bound it is
        too large rather than too small. Where teeth scatter more than that, it is their scatter. 0 for a term that
        cannot be told from another on this path.
    freedom : (3,) float
        Degrees of freedom of these standard deviations: few where they come from the scatter of few teeth.
    estimator : (3, n) float
        The coefficients are this times `depth`; zero rows for those at their bound.
    chi_square : float
    degrees_of_freedom : int
    level_free : bool
        Whether the depth is from a zero of the measuring machine's own: then no share of it is told, only how it varies.
    """

    gear: Gear
    mate: Gear
    centre_distance: float
    sharing: LoadSharing
    roll: Floats
    depth: Floats
    teeth: Floats
    errors: Floats
    known: bool
    basis: Floats
    coefficients: Floats
    covariance: Floats
    freedom: Floats
    estimator: Floats
    chi_square: float
    degrees_of_freedom: int
    level_free: bool = False

    @property
    def std(self) -> Floats:
        """Standard deviation of `depth`, mm, (n,)."""
        return np.asarray(np.sqrt(np.diag(self.errors)), dtype=np.float64)

    @property
    def fitted(self) -> Floats:
        """Depth by the law, mm, (n,)."""
        return np.asarray(self.basis @ self.coefficients, dtype=np.float64)

    @property
    def coefficient_stds(self) -> Floats:
        """(3,) mm."""
        return np.asarray(np.sqrt(np.diag(self.covariance)), dtype=np.float64)

    @property
    def path(self) -> PathOfContact:
        """Of the design."""
        return path_of_contact(self.gear, self.mate, self.centre_distance)

    def terms(self, roll: Floats) -> Floats:
        """The law's terms (n, 3) at lengths of roll (n,), mm, each for a coefficient of 1."""
        return law_terms(self.gear, self.mate, self.centre_distance, roll, self.sharing)

    def reach(self, confidence: float = 0.95) -> Floats:
        """(3,) standard deviations from the value to the limits of a two-sided interval, by Student's t.

        Raises
        ------
        InputError
            If the confidence is none (`check_confidence`).
        """
        check_confidence(confidence)
        from scipy.special import stdtrit  # scipy.stats takes a quarter of a second to import

        normal = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
        few = np.isfinite(self.freedom)
        return np.where(few, stdtrit(np.where(few, self.freedom, 1.0), 0.5 + 0.5 * confidence), normal)

    def interval(self, confidence: float = 0.95) -> Floats:
        """(3, 2) lower and upper limits of the coefficients, mm, not below 0."""
        half = self.reach(confidence) * self.coefficient_stds
        return np.asarray(np.maximum(self.coefficients[:, None] + half[:, None] * np.array([-1.0, 1.0]), 0.0), dtype=np.float64)

    @property
    def parts(self) -> dict[str, tuple[float, float]]:
        """What part of the law's mean depth over the path of contact each term makes up, with its standard deviation."""
        each = self._weight @ self.basis
        mean = float(each @ self.coefficients)
        if not mean > 0.0:
            return dict.fromkeys(TERMS, (0.0, 0.0))
        share = each * self.coefficients / mean
        slope = (np.diag(each) - np.outer(share, each)) / mean
        std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slope, self.covariance, slope), 0.0))
        return {name: (float(s), float(d)) for name, s, d in zip(TERMS, share, std, strict=True)}

    @property
    def explained(self) -> tuple[float, float]:
        """Part of the mean square of the measured depth that the law explains, with its standard deviation.

        Over the path of contact; of both the depth and what the law leaves, what the errors of the profile add on average is
        taken off. nan where the depth does not stand out from its errors, or its level is free.
        """
        if self.level_free:
            return math.nan, math.nan
        return self._explained(np.eye(len(self.roll)))

    @property
    def explained_variation(self) -> tuple[float, float]:
        """The same of the variance about the mean depth: how far the law has the shape right. nan where no shape stands out."""
        return self._explained(np.eye(len(self.roll)) - self._weight)

    @property
    def unexplained_depth(self) -> float:
        """Root mean square of what the law leaves, mm, without what the errors of the profile add."""
        left = np.eye(len(self.roll)) - self.basis @ self.estimator
        return math.sqrt(max(_square(left, self._weight, self.depth, self._doubt)[0], 0.0))

    @property
    def _weight(self) -> Floats:
        """(n,) share of the path of contact that each point stands for."""
        weight = np.gradient(self.roll)
        return np.asarray(weight / weight.sum(), dtype=np.float64)

    @property
    def _doubt(self) -> Floats:
        """Errors whose part can be taken off: none where their size was read from what the law leaves."""
        return self.errors if self.known else np.zeros_like(self.errors)

    def _explained(self, about: Floats) -> tuple[float, float]:
        left = np.eye(len(self.roll)) - self.basis @ self.estimator
        whole, form = _square(about, self._weight, self.depth, self._doubt)
        rest, form_left = _square(about @ left, self._weight, self.depth, self._doubt)
        spread = _covariances([form, form_left], self.depth, self._doubt)
        if not whole > max(2.0 * float(np.sqrt(spread[0, 0])), LEAST_STD**2):
            return math.nan, math.nan
        share = max(rest, 0.0) / whole
        slope = np.array([-share, 1.0]) / whole
        return 1.0 - share, math.sqrt(max(float(slope @ spread @ slope), 0.0))

    @property
    def single_contact(self) -> SingleContact:
        """The law fitted where one pair carries alone: there the load is known without a model of how pairs share it."""
        return self._single_contact(self.teeth)

    def _single_contact(self, teeth: Floats) -> SingleContact:
        """The same by the depths of some teeth (k, n), mm."""
        alone = self._alone
        if int(alone.sum()) < _LEAST_POINTS:
            return SingleContact(math.nan, math.nan, math.nan, math.nan)
        terms = self.basis[alone] * np.array([1.0, 1.0, 0.0])
        there = fitted(terms, teeth[:, alone], self.errors[np.ix_(alone, alone)])
        std = np.sqrt(np.diag(there.covariance))
        return SingleContact(
            sliding=float(there.coefficients[0]),
            sliding_std=float(std[0]),
            uniform=float(there.coefficients[1]),
            uniform_std=float(std[1]),
        )

    @property
    def amount(self) -> float:
        """k w N, mm, of all pairs together: of single contact where that tells it, else of the whole path.

        No place of a helical flank is in single contact. Lines that have worn carry less until wear is about even, and then the even term takes the
        place of sliding; but what is lost in section is force times way, whoever carries it. So there all of the loss is sliding's, if any of it is,
        with the load even over the lines. Load that has left fast places for slow ones makes it up to a third too small.
        """
        there, whole = self.single_contact.sliding, float(self.coefficients[0])
        if self.path.overlap_ratio > 0.0 and whole > 0.0:
            arc = self.roll * np.gradient(self.roll)
            lines = law_terms(self.gear, self.mate, self.centre_distance, self.roll, LoadSharing.LINES)[:, 0]
            whole = float(arc @ self.depth) / float(arc @ lines)
        return max(there, whole) if math.isfinite(there) else whole

    @property
    def _alone(self) -> Bools:
        """(n,) where one pair carries alone all along the stretch that a point stands for."""
        low, high = path_of_contact(self.gear, self.mate, self.centre_distance).single_contact_pinion
        return np.asarray((self.basis[:, 2] >= 1.0) & (self.roll > low) & (self.roll < high), dtype=np.bool_)

    def wear_coefficient(self, cycles_run: float, unit_load: float) -> tuple[float, float]:
        """k = A / (w N) and its standard deviation, mm²/N, for the cycles run and the load in N/mm."""
        for name, value in (("cycles run", cycles_run), ("load per face width", unit_load)):
            if not 0.0 < value < np.inf:
                raise InputError(f"{name} {value:g}: must be above 0")
        per = 1.0 / (cycles_run * unit_load)
        return float(self.coefficients[0]) * per, float(np.sqrt(self.covariance[0, 0])) * per

    @property
    def words(self) -> str:
        """One line for a report. It names what the profile is consistent with, never a mechanism."""
        if self.level_free:
            share, std = self.explained_variation
            if not np.isfinite(share):
                return (
                    "how the measured depth varies along the profile does not stand out from its errors: nothing for a law to explain; "
                    "its mean is from the machine's own zero and tells nothing"
                )
            return (
                f"the curve follows {_percent(share, std)} of how the measured depth varies along the profile (load sharing: {self.sharing}); "
                f"its mean is from the machine's own zero and tells nothing{self._coefficient_words}"
            )
        share, std = self.explained
        mean = 1e3 * float(self._weight @ self.depth)
        if not np.isfinite(share):
            return f"the mean depth of {mean:.1f} µm does not stand out from its errors: nothing for a law to explain"
        said = {
            "sliding": f"is consistent with sliding wear after Archard (load sharing: {self.sharing})",
            "uniform": "is consistent with a uniform loss",
            "step": "is consistent with more loss where one pair carries alone",
        }
        parts = [f"{_percent(*self.parts[name])} {said[name]}" for name in TERMS if self.parts[name][0] >= LEAST_PART]
        errors = ", errors taken off" if self.known else ""
        text = (
            f"the law explains {_percent(share, std)} of the measured wear (by the mean square of its depth{errors});"
            " how the teeth share the load is assumed, not known"
        )
        if parts:
            text += f". Of its mean depth of {mean:.1f} µm, {', '.join(parts)}"
        text += self._coefficient_words
        deepest = float(self.depth.max())
        if deepest > _MILD_WEAR_DEPTH:
            text += (
                f". At its deepest the mean flank has lost {1e3 * deepest:.0f} µm: more than the mild wear that the law, with the sliding of unworn"
                " flanks, is made for"
            )
        return text

    @property
    def _coefficient_words(self) -> str:
        """How far the coefficient of sliding can be relied on: beside it that of single contact, which needs no load sharing."""
        there, whole = self.single_contact, float(self.coefficients[0])
        if not (there.sliding > 0.0 or whole > 0.0):
            return ""
        if not there.sliding > 0.0:
            return f". Its coefficient A, {1e3 * whole:.1f} µm, rests on the load sharing assumed: single contact alone does not tell it"
        text = f". Its coefficient A is {1e3 * whole:.1f} µm, and {1e3 * there.sliding:.1f} ± {1e3 * there.sliding_std:.1f} µm by single contact alone"
        off = abs(whole / there.sliding - 1.0)
        # Both are of the same teeth: what these scatter by tells nothing of a difference.
        by_mean = self._single_contact(self.depth[None])
        if abs(whole - there.sliding) > 2.0 * by_mean.sliding_std and off > _LIKE_COEFFICIENTS:
            text += f", which no load sharing enters: {100 * off:.0f} % apart, so pairs did not share the load as assumed"
        return text

    def headline(self) -> str:
        std = np.sqrt(np.diag(self.covariance))
        a, b, c = (measured(1e3 * float(x), 1e3 * float(d), "µm") for x, d in zip(self.coefficients, std, strict=True))
        return f"A {a} · |K|, B {b}, C {c}; load sharing {self.sharing}"

    def rows(self) -> list[CardRow]:
        left = f"leaves {1e3 * self.unexplained_depth:.2g} µm RMS, errors {'taken off' if self.known else 'with it'}"
        return [
            ("explained", f"{_percent(*self.explained)} of the mean square depth; {left}"),
            ("profile", f"{len(self.roll)} points, L = {self.roll[0]:.2f} … {self.roll[-1]:.2f} mm"),
            ("χ²", f"{self.chi_square:.1f} with {self.degrees_of_freedom} degrees of freedom"),
        ]


@on_one_thread
def fit_wear_law(
    gear: Gear,
    mate: Gear,
    centre_distance: float,
    roll: Floats,
    depth: Floats,
    std: Floats | None = None,
    sharing: LoadSharing | None = None,
    correlation_length: float = 0.0,
    width: Floats | float = 0.0,
) -> tuple[WearFit, ...]:
    """Fit the law to the depth of worn flanks.

    Parameters
    ----------
    gear, mate : Gear
        The worn gear and the one it runs with; either of them may be a ring.
    centre_distance : float
        mm.
    roll : (n,) float
        Length of roll on `gear`, mm, rising.
    depth : (n,) or (k, n) float
        Depth (+ is missing), mm: a profile, or those of k teeth. Points outside the path of contact are left out, and
        points that are nan on any tooth: no pair touches there, and the law says nothing of what is lost.
    std : (n,) or (n, n) float or None
        Standard deviation of the (mean) depth, mm; or its covariance, mm². None: the same everywhere, of the size of what
        the teeth leave of their own fits or, for a single profile, of what the best model leaves.
    sharing : LoadSharing or None
        The load sharing, or its word, of those that are of such gears (`LoadSharing.of`); None tries them all.
    correlation_length : float
        mm of roll over which errors of `depth` are alike (they decay as exp(−ΔL/ℓ)), where `std` is no covariance; 0 is
        independent. Take it from the scan: texture makes an interval far too narrow when it is left out.
    width : (n,) float or float
        mm of roll about each `roll` over which its depth is a mean, along the flank's arc; 0: it is that of the point. Sliding is
        steep near the form circle, has a kink at the pitch point, and load sharing steps.

    Returns
    -------
    tuple of WearFit
        The best first, by χ². `alike_fits` says which cannot be told from it.

    Raises
    ------
    InputError
        If arrays do not match, a depth is beyond the middle of the tooth, too few points lie on the path of contact, a standard deviation is not positive, lengths
        of roll do not rise, the load sharing is none of such gears, or the contact ratio is 2 or more.

    Notes
    -----
    Non-negative least squares (Lawson & Hanson 1974) on data made independent by the Cholesky factor of their
    covariance. Teeth are worn unlike: with the profiles of several, the standard deviations are those of the law behind
    them, and hold the scatter of the coefficients from tooth to tooth where that is the greater, direction by direction.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion, gear = (Gear.from_spec(GearSpec(name, z, 6.35, 15.0)) for name, z in (("pinion", 12), ("gear", 24)))
    >>> roll = np.linspace(4.0, 26.0, 60)
    >>> depth = 0.004 * np.abs(1.0 - (39.093 - roll) / (2.0 * roll)) + 0.002
    >>> fit = fit_wear_law(pinion, gear, 114.3, roll, depth, np.full(60, 1e-4))[0]
    >>> fit.headline()
    'A 4.000 ± 0.024 µm · |K|, B 2.000 ± 0.038 µm, C 0.000 ± 0.035 µm; load sharing none'
    """
    for name, one in (("gear", gear), ("mate", mate)):
        check_kind(one, Gear, name, "one of design.gears")
    check_number("centre_distance", centre_distance, "mm")
    profile = _Profile.of(roll, depth, std, width)
    check_within("correlation_length", correlation_length, 0.0, math.inf, "a number from 0 up, in mm,")
    path = path_of_contact(gear, mate, centre_distance)
    profile = profile.on(path)
    deepest, thick = float(np.abs(profile.depth).max()), gear.tooth_thickness
    if deepest > 0.5 * thick:
        raise InputError(
            f"wear law: a depth of {deepest:.4g} mm is beyond the middle of a tooth {thick:.4g} mm thick: mm, not µm, would be right"
        )
    models = LoadSharing.of(gear)
    if sharing is not None:
        check_choice("sharing", sharing, models)
        models = (LoadSharing(sharing),)
    # Equal arcs are equal steps of L²; the harmonic mean of such a stretch is its middle.
    stretch = np.array([-0.5, 0.5]) * profile.width[:, None]
    edges = np.clip(profile.roll[:, None] + stretch, path.start_pinion, path.end_pinion)
    bases = [law_over(gear, mate, centre_distance, edges, model) for model in models]
    covariance = profile_covariance(profile.roll, profile.errors, correlation_length)
    if not np.linalg.eigvalsh(covariance)[0] > 0.0:
        raise InputError("wear law: the covariance of the depth must be symmetric and positive definite")
    if profile.errors is None:
        covariance = covariance * error_size(bases, profile.depth, covariance)
    parts = [fitted(basis, profile.depth, covariance) for basis in bases]
    fits = [
        WearFit(
            gear=gear,
            mate=mate,
            centre_distance=centre_distance,
            sharing=model,
            roll=profile.roll,
            depth=profile.depth.mean(axis=0),
            teeth=profile.depth,
            errors=covariance,
            known=profile.errors is not None or len(profile.depth) > 1,
            basis=basis,
            **part._asdict(),
        )
        for model, basis, part in zip(models, bases, parts, strict=True)
    ]
    return tuple(sorted(fits, key=lambda fit: fit.chi_square))


@dataclass(frozen=True, slots=True)
class _Profile:
    """Depths of teeth (k, n) at lengths of roll (n,), means over widths (n,), mm, with standard deviations (n,) or a covariance (n, n), or None."""

    roll: Floats
    depth: Floats
    errors: Floats | None
    width: Floats

    @classmethod
    def of(cls, roll: Floats, depth: Floats, std: Floats | None, width: Floats | float) -> _Profile:
        """As given to `fit_wear_law`; refused where the arrays do not match."""
        roll, depth = real_array("roll", roll), np.atleast_2d(real_array("depth", depth))
        errors = None if std is None else real_array("std", std)
        points = roll.size
        if (
            roll.ndim != 1
            or depth.shape[1:] != (points,)
            or (errors is not None and errors.shape not in ((points,), (points, points)))
        ):
            raise InputError("wear law: lengths of roll (n,), depths (n,) or (teeth, n) and standard deviations (n,) must match")
        return cls(roll, depth, errors, real_array("width", width))

    @property
    def spread(self) -> Floats | None:
        """(n,) the standard deviations, or the diagonal of the covariance: not above 0 where it is none."""
        return self.errors if self.errors is None or self.errors.ndim == 1 else np.diag(self.errors)

    def on(self, path: PathOfContact) -> _Profile:
        """What of it is known and lies on the path of contact; refused where that is too little, or no profile."""
        roll, wide, spread = self.roll, self.width, self.spread
        use = np.isfinite(self.depth).all(axis=0) & (roll >= path.start_pinion) & (roll <= path.end_pinion) & (roll > 0.0)
        if wide.shape not in ((), roll.shape) or not (wide >= 0.0).all():
            raise InputError("wear law: width must be a number of mm of roll, or one for each length of roll, and not below 0")
        # A stretch that reaches past the path, where nothing is worn, is no mean of the law.
        half = 0.5 * wide
        on_path = np.minimum(roll + half, path.end_pinion) - np.maximum(roll - half, path.start_pinion)
        use &= on_path >= LEAST_ON_PATH * 2.0 * half
        if spread is not None:
            use &= np.isfinite(spread)
        if use.sum() < _LEAST_POINTS:
            raise InputError(
                f"wear law: {int(use.sum())} points on the path of contact, L = {path.start_pinion:.3f} … {path.end_pinion:.3f} mm; at least {_LEAST_POINTS} are needed"
            )
        errors = self.errors
        if errors is not None:
            errors = errors[use] if errors.ndim == 1 else errors[np.ix_(use, use)]
        used = _Profile(roll[use], self.depth[:, use], errors, np.broadcast_to(wide, roll.shape)[use])
        if not ((used.spread is None or (used.spread > 0.0).all()) and (np.diff(used.roll) > 0.0).all()):
            raise InputError("wear law: standard deviations must be above 0 mm and lengths of roll must rise")
        return used


def alike_fits(fits: Sequence[WearFit]) -> tuple[WearFit, ...]:
    """The best of some fits to one profile and those that cannot be told from it, the best first.

    Two models of as many terms differ by Δχ² = 4 where one is e² times as likely as the other, if errors are as stated; where even
    the best leaves more than the errors allow, the difference counts in its own χ² per degree of freedom.
    """
    ordered = sorted(fits, key=lambda fit: fit.chi_square)
    best = ordered[0]
    unit = max(1.0, best.chi_square / best.degrees_of_freedom)
    return tuple(fit for fit in ordered if fit.chi_square - best.chi_square < ALIKE_CHI_SQUARE * unit)


def _square(operator: Floats, weight: Floats, depth: Floats, errors: Floats) -> tuple[float, Floats]:
    """Weighted mean square of ``operator · depth`` without what errors add on average, and its quadratic form."""
    form = operator.T @ (weight[:, None] * operator)
    return float(depth @ form @ depth - np.sum(form * errors)), form


def _covariances(forms: list[Floats], depth: Floats, errors: Floats) -> Floats:
    """Covariance of quadratic forms of normal depths: ``2 tr(P Σ Q Σ) + 4 dᵀ P Σ Q d``."""
    return np.array(
        [[2.0 * np.sum((p @ errors) * (errors @ q)) + 4.0 * depth @ p @ errors @ q @ depth for q in forms] for p in forms]
    )


def _percent(share: float, std: float) -> str:
    """A share with its standard deviation, in per cent, to the first digit of that and at most two decimals.

    >>> _percent(0.9934, 0.0021), _percent(0.41, 0.12), _percent(0.9971, 0.0)
    ('99.3 ± 0.2 %', '41 ± 12 %', '99.7 %')
    """
    if not np.isfinite(share):
        return "not known"
    digits = 1 if not std > 0.0 else min(max(-math.floor(math.log10(100.0 * std)), 0), 2)
    return f"{100 * share:.{digits}f}" + (f" ± {100 * std:.{digits}f} %" if std > 0.0 else " %")
