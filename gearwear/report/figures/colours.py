"""One signed colour scale, the same in every figure and in the 3-D view; safe for colour-blind readers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.given import check_within

DIVERGING = (
    "#053061", "#1f5fa5", "#3f8fc4", "#85bcd9", "#c6dfec", "#f5f5f3",
    "#fbd9c5", "#f2a886", "#da6a54", "#b41f31", "#67001f",
)  # fmt: skip
"""Blue is missing, red is too much, near-white is on the design (after Brewer's RdBu)."""

INK, MUTED, RULE, PAPER = "#1c2126", "#5a646e", "#d5dadf", "#ffffff"
BLUE, ORANGE, TEAL, UNSEEN = "#0b5c9c", "#b86e00", "#1b7f79", "#b4b9be"
LOST = DIVERGING[1]
"""Lost metal, wherever it is drawn: the blue that missing metal has on the scale."""
ALARM = "#c8400a"
"""What exceeds a limit or leaves its place."""

NOT_SEEN = 0.7
"""Grey of what has no deviation, in files for other programs."""


@dataclass(frozen=True, slots=True)
class ColourScale:
    """Signed scale in µm, centred on zero: linear to ± `linear_um`, then growing by the inverse sinus hyperbolicus.

    Parameters
    ----------
    limit_um : float
        Deviation at the ends of the scale; larger ones have the colour of the end.
    linear_um : float or None
        None: linear throughout.

    Raises
    ------
    InputError
        If a limit is no number above 0, or the scale is linear beyond its end.
    """

    limit_um: float
    linear_um: float | None = None

    def __post_init__(self) -> None:
        check_within("limit_um", self.limit_um, math.ulp(0.0), math.inf, "a number above 0, in µm,")
        if self.linear_um is not None:
            check_within(
                "linear_um", self.linear_um, math.ulp(0.0), self.limit_um, "a number above 0 and at most limit_um, in µm,"
            )

    def fraction(self, deviation_um: Floats) -> Floats:
        """Place on the scale, −1 … 1; nan stays nan."""
        if self.linear_um is None:
            return np.clip(deviation_um / self.limit_um, -1.0, 1.0)
        return np.clip(np.arcsinh(deviation_um / self.linear_um) / math.asinh(self.limit_um / self.linear_um), -1.0, 1.0)

    @property
    def ticks_um(self) -> tuple[float, ...]:
        """Round values to label, symmetric about zero."""
        if self.linear_um is None:
            half = [0.5 * self.limit_um, self.limit_um]
        else:
            half = [self.limit_um]
            for value in (m * 10.0**e for e in range(6, -4, -1) for m in (5.0, 2.0, 1.0)):
                if value < self.limit_um and value >= self.linear_um:
                    gap = float(self.fraction(np.array(half[-1])) - self.fraction(np.array(value)))
                    if gap > 0.17:
                        half.append(value)
            half.reverse()
        return (*(-value for value in reversed(half)), 0.0, *half)

    @property
    def tick_labels(self) -> tuple[str, ...]:
        """`ticks_um` with their signs."""
        return tuple("0" if tick == 0.0 else f"{tick:+g}".replace("-", "−") for tick in self.ticks_um)

    @property
    def words(self) -> str:
        """How to read it, for captions."""
        return self._words("±")

    @property
    def depth_words(self) -> str:
        """The same where it is a scale of depths, which have no sign."""
        return self._words("")

    def _words(self, sign: str) -> str:
        if self.linear_um is None:
            return f"The colour scale is linear and ends at {sign}{self.limit_um:g} µm."
        return (
            f"The colour scale ends at {sign}{self.limit_um:g} µm; it is about linear to {sign}{self.linear_um:g} µm and logarithmic"
            " beyond, so that deep wear and a few micrometres both show."
        )


def paint(deviation_um: Floats, scale: ColourScale) -> Floats:
    """Red, green and blue of deviations on a scale, (n, 3), 0 … 1; nan is grey."""
    steps = np.array([[int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)] for colour in DIVERGING])
    place = 0.5 * (scale.fraction(deviation_um) + 1.0) * (len(steps) - 1)
    colour = np.column_stack([np.interp(place, np.arange(len(steps)), channel) for channel in steps.T])
    return np.where(np.isfinite(deviation_um)[:, None], colour, NOT_SEEN)


def colour_scale(*maps_um: Floats | None, floor_um: float = 5.0) -> ColourScale:
    """Scale that holds all the maps (µm): linear where their bulk fills it, else linear in the middle only.

    Parameters
    ----------
    maps_um : arrays or None
        Deviations; nan and None are passed over.
    floor_um : float
        Least limit.

    >>> import numpy as np
    >>> colour_scale(np.linspace(-30.0, 38.0, 100))
    ColourScale(limit_um=40.0, linear_um=None)
    """
    seen = [np.abs(values[np.isfinite(values)]) for values in maps_um if values is not None]
    size = np.concatenate([values.ravel() for values in seen]) if seen else np.zeros(0)
    if not size.size:
        return ColourScale(floor_um)
    # Single cells at holes and edges must not set the scale, hence not the maximum.
    limit = _round_up(max(float(np.quantile(size, 0.9995)), floor_um))
    bulk = _round_up(max(float(np.quantile(size, 0.75)), floor_um))
    return ColourScale(limit, bulk) if limit > 8.0 * bulk else ColourScale(limit)


def _round_up(value: float) -> float:
    """Next of 1, 1.5, 2, 3, 4, 5, 6, 8 × 10ⁿ."""
    power = 10.0 ** math.floor(math.log10(value))
    step = next(m for m in (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0) if value <= m * power * (1.0 + 1e-9))
    return float(f"{step * power:.6g}")
