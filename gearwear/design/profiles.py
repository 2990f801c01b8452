"""A gear as it is: the polar profile of every tooth side in every transverse slice.

One representation serves the nominal and the worn gear, thickness, contact and solids: at radius r the
flank of tooth k lies at the angle θ_k + κ(z − b/2) + s ψ(r), so all is said by the half angle ψ[k, s, z, r].
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.card import Card
from gearwear.design.gear import Gear
from gearwear.design.given import check_several, rising
from gearwear.design.quantity import as_given, at_least, at_most, counted
from gearwear.design.side import Side
from gearwear.errors import InputError, check_kind

ROUNDING = 1e-9
"""mm; of a radius that came from a diameter."""


@dataclass(frozen=True, slots=True)
class SectionLoss:
    """How much thinner than drawn a tooth is, at most.

    Parameters
    ----------
    value : float
        mm of arc at the reference circle; below 0 where all teeth are thicker than drawn.
    tooth : int
        0-based.
    z : float
        Height on that tooth, mm.
    """

    value: float
    tooth: int
    z: float


@dataclass(frozen=True, slots=True, repr=False)
class ToothProfiles(Card):
    """Half angles of all tooth sides.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    radius : (n_r,) float
        Radii in mm, rising, from the root circle (or above) to the tip circle; of a ring from the tip circle.
    z : (n_z,) float
        Heights of the slices in mm, rising.
    half_angle : (teeth, 2, n_z, n_r) float
        ψ in rad from the nominal tooth centre line at the slice's own height; left first (`Side.index`). Less is worn.
    measured : (teeth, 2) bool or None
        The flanks that somebody measured, where others were filled in after them; None: all alike.
    lost : SectionLoss or None
        What was measured of the thickness besides, without the bias of having looked for the most; None: it is what the half angles say. Who changes these
        sets it to None.
    """

    gear: Gear
    radius: Floats
    z: Floats
    half_angle: Floats
    measured: Bools | None = None
    lost: SectionLoss | None = None

    def headline(self) -> str:
        known = int(np.isfinite(self.half_angle).all(axis=(2, 3)).sum())
        return f"{known} of {2 * self.gear.teeth} flanks known, {len(self.radius)} radii and {counted(len(self.z), 'height')}; {self.gear.headline()}"

    @property
    def loss(self) -> Floats:
        """Normal depth r_b cos β_b (ψ_nominal − ψ), mm, + is missing; shape of `half_angle`. Exact on the involute."""
        return self.gear.normal_lever * (self.gear.half_angles(self.radius, self.z) - self.half_angle)

    def at_heights(self, z: Floats) -> Floats:
        """Half angles at other heights: (teeth, 2, len(z), n_r); linear in z, constant beyond the ends."""
        psi, heights = self.half_angle, self.z
        if len(heights) == 1:
            return np.broadcast_to(psi, (*psi.shape[:2], len(z), psi.shape[3]))
        if np.array_equal(heights, z):
            return psi
        low = np.clip(np.searchsorted(heights, z, side="right") - 1, 0, len(heights) - 2)
        part = np.clip((z - heights[low]) / (heights[low + 1] - heights[low]), 0.0, 1.0)[:, None]
        return np.asarray((1.0 - part) * psi[:, :, low] + part * psi[:, :, low + 1], dtype=np.float64)

    def thickness(self, radius: float) -> Floats:
        """Tooth thickness r (ψ_left + ψ_right) at `radius`, mm of arc; (teeth, n_z). InputError beyond the radii that are known."""
        if not self.radius[0] - ROUNDING <= radius <= self.radius[-1] + ROUNDING:
            raise InputError(
                f"radius {as_given(radius)} mm: the profiles are known from {at_least(self.radius[0])} to {at_most(self.radius[-1])} mm, and one of these would be right"
            )
        whole = self.half_angle.sum(axis=1)
        at = np.apply_along_axis(lambda psi: np.interp(radius, self.radius, psi), -1, whole)
        return np.asarray(radius * at, dtype=np.float64)


def section_heights(gear: Gear) -> Floats:
    """Heights (mm) of sections that say how the flanks vary along the face: mid-face alone, or 33 and the knees where they do."""
    if not gear.modified_along_face:
        return np.array([0.5 * gear.face_width])
    knees = [knee for side in Side for knee in gear.drawn(side).face_knees]
    return np.union1d(np.linspace(0.0, gear.face_width, 33), knees)


def section_radii(gear: Gear) -> Floats:
    """Radii (mm, rising) of a profile: 200 between the root circle and the flank's end, and the knees of what is modified."""
    low, high = sorted((gear.root_radius, gear.flank_end_radius))
    even = np.linspace(low, high, 200)
    if not gear.modified:
        return even
    knees = [math.hypot(gear.base_radius, knee) for side in Side for knee in gear.drawn(side).profile_knees]
    return np.union1d(even, [gear.form_radius, *knees])


def profiles_of_pair(name: str, given: object, right: str) -> tuple[ToothProfiles, ToothProfiles]:
    """Two profiles as they were given, in their order; refused where these are none."""
    for one in (both := check_several(name, given, right)):
        check_kind(one, ToothProfiles, f"one of {name}", "what gw.nominal_profiles returns")
    if len(both) != 2:
        raise InputError(f"{name}: {len(both)} given; {right} would be right")
    return both[0], both[1]


def nominal_profiles(gear: Gear, radius: Floats | None = None, z: Floats | None = None) -> ToothProfiles:
    """The design itself as `ToothProfiles`.

    Parameters
    ----------
    gear : Gear
    radius : (n_r,) float or None
        Radii in mm, rising; None: `section_radii`.
    z : (n_z,) float or None
        Heights of the slices in mm, rising, of a helical gear too: half angles are about the tooth's centre line at each height, and turn with it. None:
        `section_heights`, which is mid-face alone unless the drawing modifies the flanks along the face. One slice stands for the whole face; wear that
        varies along it needs heights of its own, as ``np.linspace(0.0, gear.face_width, 33)``.

    Raises
    ------
    InputError
        If `gear` is no gear, or radii or heights are no numbers that rise.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> nominal_profiles(Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))).half_angle.shape
    (12, 2, 1, 200)
    """
    check_kind(gear, Gear, "gear", "one of design.gears")
    radius = section_radii(gear) if radius is None else rising("radius", radius)
    z = section_heights(gear) if z is None else rising("z", z)
    psi = gear.half_angles(radius, z)
    return ToothProfiles(gear, radius, z, np.broadcast_to(psi, (gear.teeth, *psi.shape)).copy())


def straight_weights(places: Floats, where: Floats) -> Floats:
    """Weights (n, k) of values at `places` (k,) for straight lines between them, and on beyond the outer ones."""
    if len(places) == 1:
        return np.ones((len(where), 1))
    low = np.clip(np.searchsorted(places, where) - 1, 0, len(places) - 2)
    share = (where - places[low]) / (places[low + 1] - places[low])
    weights = np.zeros((len(where), len(places)))
    rows = np.arange(len(where))
    weights[rows, low], weights[rows, low + 1] = 1.0 - share, share
    return weights
