"""What two gears do in mesh under load: the result of `contact.loaded_contact`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.loaded.hertz import greatest_pressure, half_width
from gearwear.loaded.pair_compliance import curvature_radius
from gearwear.loaded.steel import Material

EDGE_MODULES = 0.02
"""Length of roll, in modules, next to a tip corner that counts as the corner."""
CELLS = 24
"""Cells of the load map from the base circle to the tip."""


class FlankMap(NamedTuple):
    """Over the flank of the driver: edges of the cells in length of roll (c + 1,) and heights (s,), mm; values (teeth, c, s)."""

    roll_edges: Floats
    z: Floats
    values: Floats


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class LoadedContact(Card):
    """Positions p, pairs m (not in the same order everywhere), slices s.

    Parameters
    ----------
    driver, driven : Gear
    material : Material
    drive_side : Side
    total : float
        Transverse force, torque over base radius, N.
    centre_distance, misalignment : float
        mm.
    per_pitch : int
        Positions per pitch.
    rotation : (p,) float
        Of the driver, rad.
    rigid_transmission_error, transmission_error : (p,) float
        On the driven gear's transverse line of action, mm, from that of the unloaded design; less than zero is behind.
    compliance : (p,) float
        −dA/dF of the loaded advance, mm/N.
    z, widths : (s,) float
        Slices: their middles on the driver, and widths, mm.
    driver_tooth, driven_tooth : (p, m) int
        0-based.
    force : (p, m, s) float
        N on each slice of each pair, transverse.
    roll, mate_roll : (p, m, s) float
        Length of roll of the contact on driver and driven gear, mm.
    """

    driver: Gear
    driven: Gear
    material: Material
    drive_side: Side
    total: float
    centre_distance: float
    misalignment: float
    per_pitch: int
    rotation: Floats
    rigid_transmission_error: Floats
    transmission_error: Floats
    compliance: Floats
    z: Floats
    widths: Floats
    driver_tooth: Ints
    driven_tooth: Ints
    force: Floats
    roll: Floats
    mate_roll: Floats

    @property
    def load_per_width(self) -> float:
        """F / b, N/mm."""
        return self.total / float(self.widths.sum())

    @property
    def lag(self) -> Floats:
        """(p,) how far the driven gear falls behind by load, mm."""
        return self.rigid_transmission_error - self.transmission_error

    @property
    def mean_lag(self) -> float:
        """Mean of `lag`, mm."""
        return float(self.lag.mean())

    @property
    def peak_to_peak(self) -> float:
        """Of the loaded transmission error, mm."""
        return float(np.ptp(self.transmission_error))

    @property
    def rigid_peak_to_peak(self) -> float:
        """Of the rigid transmission error at the same positions, mm."""
        return float(np.ptp(self.rigid_transmission_error))

    def harmonics(self, count: int = 5, rigid: bool = False) -> Floats:
        """Amplitudes of the transmission error at 1 to `count` times the mesh frequency, mm.

        Positions tell no order beyond half of those in a pitch, for which 0 stands. At half they tell the part that is greatest or least at
        them, a cosine from the first position on.
        """
        error = self.rigid_transmission_error if rigid else self.transmission_error
        pitches = len(error) // self.per_pitch
        spectrum = 2.0 * np.abs(np.fft.rfft(error)) / len(error)
        if len(error) % 2 == 0:
            spectrum[-1] *= 0.5  # half the sampling rate is its own negative: one line, not two
        orders = pitches * np.arange(1, count + 1)
        return np.asarray(
            np.where(orders < len(spectrum), spectrum[np.minimum(orders, len(spectrum) - 1)], 0.0), dtype=np.float64
        )

    @property
    def stiffness(self) -> Floats:
        """(p,) tangent mesh stiffness per face width, N/(mm µm); inf without load."""
        with np.errstate(divide="ignore"):
            return np.asarray(1e-3 / (self.compliance * self.widths.sum()), dtype=np.float64)

    @property
    def load(self) -> Floats:
        """(p, m, s) transverse load per width, and so normal load per length of the contact line, N/mm."""
        return self.force / self.widths

    @property
    def load_share(self) -> Floats:
        """(p, m) share of the force on each pair; 0 without load."""
        return self.force.sum(axis=2) / self.total if self.total > 0.0 else np.zeros(self.force.shape[:2])

    @property
    def pairs_in_contact(self) -> Ints:
        """(p,) number of pairs that carry."""
        return np.asarray((self.force.sum(axis=2) > 0.0).sum(axis=1), dtype=np.int64)

    @property
    def contact_ratio(self) -> float:
        """Mean number of pairs that carry."""
        return float(self.pairs_in_contact.mean())

    @property
    def face_load_factor(self) -> float:
        """Greatest over mean load per width along the face, each summed over the pairs in contact; the greatest of all positions.

        Of a helical gear, whose contact lines run across the face, each is the mean over a pitch.
        """
        lines = self.force.sum(axis=1) / self.widths
        if self.driver.twist != 0.0:
            lines = lines.reshape(-1, self.per_pitch, len(self.widths)).mean(axis=1)
        mean = self.load_per_width
        return float(lines.max() / mean) if mean > 0.0 else 1.0

    @property
    def curvature(self) -> Floats:
        """(p, m, s) relative radius of curvature across the contact line, mm."""
        return curvature_radius(self.roll, self.mate_roll, self.driver.base_helix_cosine)

    @property
    def on_edge(self) -> Bools:
        """(p, m, s) whether a tip corner carries, or the flank below its form circle: no pressure is known there."""
        near = EDGE_MODULES * self.driver.transverse_module
        corner = (self.roll > self.driver.tip_roll - near) | (self.mate_roll > self.driven.tip_roll - near)
        below = (self.roll < self.driver.form_roll) | (self.mate_roll < self.driven.form_roll)
        return np.asarray(corner | below, dtype=np.bool_)

    @property
    def pressure(self) -> Floats:
        """(p, m, s) greatest Hertzian pressure, MPa; nan where `on_edge`."""
        return np.where(self.on_edge, np.nan, greatest_pressure(self.load, self.curvature, self.material))

    @property
    def contact_half_width(self) -> Floats:
        """(p, m, s) half width of the contact, mm."""
        return half_width(self.load, self.curvature, self.material)

    @property
    def greatest_pressure(self) -> float:
        """Over all positions, MPa, without edges; nan where only edges carry."""
        known = self.pressure[self.force > 0.0]
        known = known[np.isfinite(known)]
        return float(known.max()) if len(known) else math.nan

    @property
    def edge_load(self) -> float:
        """Greatest share of the force that corners carry in a position."""
        return float(np.where(self.on_edge, self.force, 0.0).sum(axis=(1, 2)).max() / self.total) if self.total > 0.0 else 0.0

    def load_map(self, cells: int = CELLS) -> FlankMap:
        """Greatest load per width of every cell of the driver's flanks, N/mm; 0 where nothing is carried."""
        edges = np.linspace(0.0, self.driver.tip_roll, cells + 1)
        values = np.zeros((self.driver.teeth, cells, len(self.z)))
        cell = np.clip(np.searchsorted(edges, self.roll, side="right") - 1, 0, cells - 1)
        tooth = np.broadcast_to(self.driver_tooth[..., None], self.roll.shape)
        at = np.broadcast_to(np.arange(len(self.z)), self.roll.shape)
        np.maximum.at(values, (tooth, cell, at), self.load)
        return FlankMap(edges, self.z, values)

    def share_along(self, cells: int = 2 * CELLS) -> tuple[Floats, Floats]:
        """Mean share of the force on a pair that touches the driver's flank in each cell: lengths of roll (c,), mm, and shares (c,); nan where
        no pair carries."""
        edges = np.linspace(0.0, self.driver.tip_roll, cells + 1)
        carried = self.force.sum(axis=2)
        on = carried > 0.0
        place = (self.force * self.roll).sum(axis=2)[on] / carried[on]
        cell = np.clip(np.searchsorted(edges, place, side="right") - 1, 0, cells - 1)
        number = np.bincount(cell, minlength=cells)
        share = np.bincount(cell, self.load_share[on], minlength=cells)
        return 0.5 * (edges[1:] + edges[:-1]), np.where(number > 0, share / np.maximum(number, 1), np.nan)

    @property
    def contact_pattern(self) -> Floats:
        """(s,) share of the positions in which a slice carries anything."""
        return np.asarray((self.force.sum(axis=1) > 0.0).mean(axis=0), dtype=np.float64)

    def headline(self) -> str:
        return f"{self.load_per_width:.4g} N/mm on z = {self.driver.teeth} / {self.driven.teeth}, {len(self.rotation)} positions"

    def rows(self) -> list[CardRow]:
        stiff = self.stiffness
        said = [
            ("transmission error", f"{1e3 * self.peak_to_peak:.2f} µm peak to peak, rigid {1e3 * self.rigid_peak_to_peak:.2f} µm; mean lag {1e3 * self.mean_lag:z.2f} µm"),
            ("contact ratio", f"{self.contact_ratio:.3f} under load"),
        ]  # fmt: skip
        if self.total > 0.0:
            said += [
                ("mesh stiffness", f"{stiff.mean():.1f} N/(mm µm), {stiff.min():.1f} to {stiff.max():.1f}"),
                ("pressure", f"{self.greatest_pressure:.0f} MPa at most, away from edges; edges carry {100 * self.edge_load:.0f} % at most"),
            ]  # fmt: skip
        return said
