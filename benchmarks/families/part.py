"""A gear as it lies on the bench: its section, how it was made, what is worn, what is broken off."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchmarks.families.breakage import Cut
from benchmarks.families.fields import Field, Frame
from benchmarks.families.gear import Array, Bools, GearNumbers
from benchmarks.families.rack import Tool
from benchmarks.families.section import Section, section


@dataclass(frozen=True, eq=False)
class Part:
    """The true gear.

    Parameters
    ----------
    gear : GearNumbers
    tools : tuple of Tool
        What cut its spaces.
    made : tuple of Field
        Deviations of manufacture, and metal that running put on (a burr): all that is no loss.
    wear : tuple of Field
        Losses; their sum is never positive.
    cuts : tuple of Cut
        What is broken off.
    """

    gear: GearNumbers
    tools: tuple[Tool, ...]
    made: tuple[Field, ...] = ()
    wear: tuple[Field, ...] = ()
    cuts: tuple[Cut, ...] = ()

    @cached_property
    def section(self) -> Section:
        return section(self.gear, self.tools)

    @cached_property
    def frame(self) -> Frame:
        return Frame.of(self.gear, self.section.form_roll)

    def as_made(self, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        """Deviation of flanks before running, mm."""
        return sum((field(self.frame, tooth, side, roll, z) for field in self.made), np.zeros(np.broadcast(tooth, roll, z).shape))

    def loss(self, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        """Deviation by wear, never positive, mm."""
        return sum((field(self.frame, tooth, side, roll, z) for field in self.wear), np.zeros(np.broadcast(tooth, roll, z).shape))

    def deviation(self, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        """Of flanks as they are."""
        return self.as_made(tooth, side, roll, z) + self.loss(tooth, side, roll, z)

    def foot(self, tooth: Array, side: Array, reached: Array, z: Array) -> Array:
        """Roll length of the foot whose moved point lies at the roll length `reached`: L + δ(L) = reached."""
        roll = np.array(np.broadcast_to(reached, np.broadcast(tooth, reached, z).shape), dtype=np.float64)
        for _ in range(6):
            roll = reached - self.deviation(tooth, side, np.maximum(roll, self.frame.form), z)
        return roll

    def half_angle(self, tooth: Array, side: Array, rho: Array, z: Array) -> Array:
        """Angle from the tooth's centre line to its surface as it is, at a radius; breakage left out."""
        plain = self.section.half_angle(rho)
        reached = np.sqrt(np.maximum(rho**2 - self.gear.base_radius**2, 0.0))
        flank = (rho >= self.section.form_radius) & (rho <= self.gear.tip_radius + 1e-9)
        moved = self.deviation(tooth, side, np.maximum(self.foot(tooth, side, reached, z), self.frame.form), z)
        below = self.as_made(tooth, side, np.full(np.shape(rho), self.frame.form), z)
        shift = np.where(flank, moved, np.where(rho < self.section.form_radius, below, 0.0)) / self.gear.base_radius
        return np.where(rho <= self.section.root_radius[0], plain, plain + shift)

    def angle_in_tooth(self, points: Array) -> tuple[Array, Array, Array]:
        """Nearest tooth, angle from its centre line and radius of points of the design frame."""
        theta = np.arctan2(points[:, 1], points[:, 0])
        tooth = np.round(theta / self.gear.pitch_angle)
        return np.mod(tooth, self.gear.teeth), theta - tooth * self.gear.pitch_angle, np.hypot(points[:, 0], points[:, 1])

    def solid(self, points: Array, nominal: bool = False) -> Bools:
        """Which points lie in metal (between the ends; breakage counts where not `nominal`; without a bore)."""
        tooth, angle, rho = self.angle_in_tooth(points)
        side = np.where(angle >= 0.0, 1.0, -1.0)
        limit = self.section.half_angle(rho) if nominal else self.half_angle(tooth, side, rho, points[:, 2])
        limit = np.where(rho < self.section.root_radius[0], math.pi, limit)
        inside = (np.abs(angle) < limit) & (points[:, 2] > 0.0) & (points[:, 2] < self.gear.face_width)
        if not nominal:
            for cut in self.cuts:
                inside &= ~((tooth == cut.tooth) & (rho > self.section.root_radius[0]) & (cut.beyond(points) > 0.0))
        return inside
