"""What the figures take: refused in words where it is something else, before it ends in an error of matplotlib or numpy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gearwear.design.gear import Gear
from gearwear.design.given import check_within
from gearwear.design.quantity import shown
from gearwear.diagnose.found import Loop
from gearwear.errors import InputError, check_kind
from gearwear.loaded.study import LoadedStudy
from gearwear.meshing.exact import ExactMeshing
from gearwear.meshing.path import PathOfContact, Sliding
from gearwear.report.figures.arrays import MeshingCurves
from gearwear.report.figures.colours import ColourScale
from gearwear.running.found import SecondLoop
from gearwear.wear.thickness import SectionThickness
from gearwear.wear_law.across import AcrossFace
from gearwear.wear_law.study import WearStudy

RIGHT: dict[type, str] = {
    AcrossFace: "what results.pair.law.across holds",
    ColourScale: "a gearwear.report.figures.colours.ColourScale",
    ExactMeshing: "what gw.exact_meshing returns",
    Gear: "one of design.gears",
    LoadedStudy: "what gw.study_load returns",
    Loop: "that of a gear whose effects were looked for (loop=True, gw.find_effects)",
    MeshingCurves: "gw.report_arrays(results).meshing, of a pair,",
    PathOfContact: "study.exact.path of what gw.study_meshing returns",
    SecondLoop: "what results.pair.second_loop holds",
    SectionThickness: "results.wear.thickness",
    Sliding: "study.sliding of what gw.study_meshing returns",
    WearStudy: "results.pair.law, of a pair,",
}
"""What would be right where a figure is of a thing of this kind."""


def check_axis(axis: object, name: str = "axis") -> None:
    """Refuse what is no axis to draw on: a figure, the module pyplot, an array of axes."""
    from matplotlib.axes import Axes

    check_kind(axis, Axes, name, "an axis of matplotlib, as plt.subplots()[1] is,")


def check_drawn(kind: type, **given: object) -> None:
    """Refuse what is no thing of this kind, by its name.

    >>> check_drawn(SectionThickness, thickness=9.7)
    Traceback (most recent call last):
    gearwear.errors.InputError: thickness of type float: results.wear.thickness would be right
    """
    for name, value in given.items():
        check_kind(value, kind, name, RIGHT[kind])


def check_above_zero(**given: object) -> None:
    """Refuse what is no finite number above 0, by its name; any unit is in that."""
    for name, value in given.items():
        check_within(name, value, math.ulp(0.0), math.inf, "a number above 0")


def check_colour(colour: object) -> None:
    """Refuse what matplotlib does not know as a colour.

    >>> check_colour("no colour")
    Traceback (most recent call last):
    gearwear.errors.InputError: colour = 'no colour': one of matplotlib, such as '#0b5c9c' or 'tab:blue', would be right
    """
    from matplotlib.colors import is_color_like

    if not is_color_like(colour):
        raise InputError(f"colour = {shown(colour)}: one of matplotlib, such as '#0b5c9c' or 'tab:blue', would be right")


def check_arrays(**given: tuple[Any, tuple[int | str, ...]]) -> None:
    """Refuse arrays of another shape: lengths that have one name are the same.

    >>> check_arrays(share=(np.zeros((12, 2, 5)), ("teeth", 2, "n_z", "n_L")))
    Traceback (most recent call last):
    gearwear.errors.InputError: share of shape (12, 2, 5): an array (teeth, 2, n_z, n_L) would be right
    >>> check_arrays(along=(np.zeros(3), ("n",)), depth=(np.zeros(4), ("n",)))
    Traceback (most recent call last):
    gearwear.errors.InputError: depth of shape (4,): an array (n,) with n = 3, as along has, would be right
    """
    known: dict[str, tuple[int, str]] = {}
    for name, (value, shape) in given.items():
        right = f"an array ({', '.join(map(str, shape))}{',' * (len(shape) == 1)})"
        check_kind(value, np.ndarray, name, f"{right} of numbers")
        if value.dtype.kind not in "fiu":
            raise InputError(f"{name} of type {value.dtype}: {right} of numbers would be right")
        fits = value.ndim == len(shape) and value.size > 0
        for length, wanted in zip(value.shape, shape, strict=True) if fits else ():
            if isinstance(wanted, int):
                fits = fits and length == wanted
            elif (first := known.setdefault(wanted, (length, name)))[0] != length:
                raise InputError(
                    f"{name} of shape {value.shape}: {right} with {wanted} = {first[0]}, as {first[1]} has, would be right"
                )
        if not fits:
            raise InputError(f"{name} of shape {value.shape}: {right} would be right")
