"""The scanned gear run against its mate: its flanks as they are, as they would be with the effects left in, and as they may as well be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from gearwear.arrays import Floats
from gearwear.comparison.contributions import SideFields
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles, nominal_profiles, section_heights
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.loaded.study import LoadedStudy, not_modelled, study_load
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.linear import LinearResult, linear_contact
from gearwear.meshing.passes import Cycle
from gearwear.meshing.slices import facing_mate, heights_beside
from gearwear.meshing.spread import ContactSpread, contact_spread
from gearwear.meshing.study import facing
from gearwear.placing.cells import CellGrid
from gearwear.processors import each, room
from gearwear.wear.profiles import ProfileNodes, crest_left, node_heights, without_added_metal, worn_profiles
from gearwear.wear.smooth import WornSurface

POSITIONS, PARTS = 34, 4
"""Positions per pitch; steps of the profile to a column of cells."""


@dataclass(frozen=True, slots=True)
class ToothSides:
    """The tooth sides of the scanned gear for contact.

    Parameters
    ----------
    nodes : ProfileNodes
    area : (columns,) float
        Of the cells, mm².
    depth, made : (teeth, 2, rows, fillet + flank) float
        What is missing, and too much as it was made, mm.
    crest : (2, rows, nodes) float
        `crest_left` of what is missing.
    """

    nodes: ProfileNodes
    area: Floats
    depth: Floats
    made: Floats
    crest: Floats

    @classmethod
    def of(cls, grid: CellGrid, depth: Floats, area: Floats, made: Floats) -> ToothSides:
        """Metal that was not made so was not put on."""
        missing = without_added_metal(depth, area)
        return cls(ProfileNodes.of(grid, PARTS), area, missing, made, crest_left(grid, missing, PARTS))

    def lacking(self, depth: Floats) -> ToothSides:
        """The same with another depth missing, mm."""
        return replace(self, depth=without_added_metal(depth, self.area))

    def profiles(self, added: Floats | float = 0.0) -> ToothProfiles:
        """With so much more metal on them, mm."""
        return worn_profiles(self.nodes, self.depth, self.made + added, self.crest)


@dataclass(frozen=True, slots=True)
class RunningGear:
    """The scanned gear for contact.

    Parameters
    ----------
    present : ToothProfiles
        As it is: manufacture and wear.
    put_back : tuple of ToothProfiles
        With all effects that were taken out put back, then with each alone, in the order of `SideFields.taken`; empty where there are none.
    drawn : tuple of ToothProfiles
        As it may as well be: the worn surface and the size of every effect drawn from what is known of them.
    drawn_again : tuple of ToothProfiles
        Each of these with what another of them is off by put on it as well.
    made : ToothProfiles
        As it was made, without wear.
    """

    present: ToothProfiles
    put_back: tuple[ToothProfiles, ...]
    drawn: tuple[ToothProfiles, ...]
    drawn_again: tuple[ToothProfiles, ...]
    made: ToothProfiles

    @classmethod
    def of(cls, grid: CellGrid, surface: WornSurface, area: Floats, fields: SideFields) -> RunningGear:
        """From the worn surface, the area of its cells (columns,) in mm², and what the effects do to it."""
        sides = ToothSides.of(grid, surface.depth, area, fields.made)
        nothing = np.zeros_like(sides.depth)
        present = sides.profiles()
        random = np.random.default_rng(len(fields.unsure))
        sizes = random.normal(size=(len(surface.draws), len(fields.unsure)))
        effects_off = np.array(
            [sum((size * field for size, field in zip(draw, fields.unsure, strict=True)), nothing) for draw in sizes]
        )
        fields_back = (fields.raw, *fields.taken.values()) if fields.raw.any() else ()

        found = room(2, len(sizes), *present.half_angle.shape)

        def scattered(surfaces: Floats, off: Floats, out: Floats) -> None:
            """Half angles alone: they come from another process, and the gear is this one's."""
            for depth, added, half_angle in zip(surfaces, off, out, strict=True):
                half_angle[...] = sides.lacking(depth).profiles(added).half_angle

        other = np.roll(np.arange(len(sizes)), -1)
        also = surface.draws + surface.draws[other] - surface.depth, effects_off + effects_off[other]
        each([partial(scattered, surface.draws, effects_off, found[0]), partial(scattered, *also, found[1])])
        drawn, drawn_again = (tuple(replace(present, half_angle=psi) for psi in one) for one in found)
        return cls(
            present,
            tuple(sides.profiles(field) if field.any() else present for field in fields_back),
            drawn,
            drawn_again,
            replace(sides, depth=nothing).profiles(),
        )

    def against_mate(self, design: Design, measured: MeasuredGear, side: Side) -> tuple[ContactResult, ContactSpread]:
        """Rigid contact over one revolution of the scanned gear, `side` of the scanned gear carrying; its variants are those of `put_back`."""
        in_order = beside_mate(design, measured)
        variants = list(map(in_order, (*self.put_back, *self.drawn, *self.drawn_again)))
        contact = mesh_of_scanned(design, measured, in_order(self.present), side, variants)
        first, again = len(self.put_back), len(self.put_back) + len(self.drawn)
        spread = contact_spread(contact.variants[first:again], contact.variants[again:], sum(measured.level_std))
        return replace(contact, variants=contact.variants[:first]), spread

    def under_load(self, design: Design, measured: MeasuredGear, side: Side) -> LoadedStudy | None:
        """The same flanks under the design's load; None where it states none, or the gears are none that it can be modelled for."""
        if design.load is None or not_modelled(design):
            return None
        in_order = beside_mate(design, measured)
        return study_load(
            design, in_order(self.present), None, side, drawn=list(map(in_order, self.drawn)), cycle=_cycle(measured)
        )

    def as_made(self, design: Design, measured: MeasuredGear, side: Side) -> LinearResult | None:
        """The gear without wear in mesh; deviations are small and gentle, so that the linear model serves. None where it does not."""
        try:
            carrying = facing(measured.gear, side)
            return linear_contact(
                *beside_mate(design, measured)(self.made), design.centre_distance, carrying, cycle=_cycle(measured)
            )
        except InputError:
            return None


def mesh_of_scanned(
    design: Design,
    measured: MeasuredGear,
    pair: tuple[ToothProfiles, ToothProfiles],
    side: Side,
    variants: Sequence[tuple[ToothProfiles, ToothProfiles]] = (),
) -> ContactResult:
    """Rigid contact of a pair that `beside_mate` put in order, over one revolution of the scanned gear, `side` of which carries."""
    return mesh_contact(
        *pair, design.centre_distance, facing(measured.gear, side), positions_per_pitch=POSITIONS, cycle=_cycle(measured), variants=variants
    )  # fmt: skip


def _cycle(measured: MeasuredGear) -> Cycle:
    """A revolution of the scanned gear: every tooth of it meets the mate, whose teeth are all alike."""
    return "driven" if measured.part == "gear" else "revolution"


def beside_mate(design: Design, measured: MeasuredGear) -> Callable[[ToothProfiles], tuple[ToothProfiles, ToothProfiles]]:
    """A function that puts the scanned gear's profiles and the nominal mate in order: pinion, gear."""
    driven = measured.part == "gear"
    mate = design.gears["pinion" if driven else "gear"]
    heights = section_heights(mate)
    if driven:  # the slices are the driver's
        heights = heights_beside(mate, node_heights(measured.cells.grid), measured.gear)
    least, most = sorted((mate.root_radius, mate.tip_radius))
    other = nominal_profiles(mate, np.linspace(least, most, 200), heights)

    def in_order(scanned: ToothProfiles) -> tuple[ToothProfiles, ToothProfiles]:
        own = facing_mate(scanned, mate)
        return (other, own) if driven else (own, other)

    return in_order
