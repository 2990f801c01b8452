"""The comparison, station by station: from scans and a design to `Results`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from pathlib import Path

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import LEFT, RIGHT, ToothProfiles, nominal_profiles
from gearwear.design.surface import FLANK, OTHER, Bands, SurfacePoints, flank_points, locate
from gearwear.diagnose.effects.base import Context, Kind
from gearwear.diagnose.loop import Loop, close_loop, make_context
from gearwear.errors import InputError
from gearwear.measure.cells import CellGrid, Cells, bin_points
from gearwear.measure.inspection.inspection import Inspection, Settings, inspect
from gearwear.measure.pose import Pose, motion_columns, small_motion
from gearwear.measure.registration import stray_limit
from gearwear.measure.sheet import make_sheets
from gearwear.measure.thickness import SectionThickness, section_thickness
from gearwear.measure.views import PlacedScan, place
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.exact import exact_meshing
from gearwear.meshing.published import published_meshing
from gearwear.meshing.shafts import shaft_movement
from gearwear.report.results import MeshingStudy, PlainBoolean, Results, Solids
from gearwear.scan.reading import read_scan
from gearwear.scan.types import Scan
from gearwear.scan.units import check_size
from gearwear.wear.laws import fit_laws
from gearwear.wear.profiles import worn_profiles
from gearwear.wear.regions import Wear, find_wear
from gearwear.wear.solid import Triangles, gear_triangles, nominal_like, signed_difference, worn_bodies

Progress = Callable[[str], None]
"""Told the name of each station as it begins."""

DISTORTED = 0.02
"""Root mean square deviation, in modules, above which a scan is located again with what the loop found."""
BAND_OF_SURFACE = ("flank", "flank", "root", "tip", "end_low", "end_high", "bore")
"""Field of `Bands` for each surface code."""
MEASURED = frozenset({Kind.MEASUREMENT, Kind.MOUNTING})
MADE = frozenset({Kind.MANUFACTURE})


def compare(
    design: Design,
    scans: Sequence[str | Path],
    part: str | None = None,
    before: Sequence[str | Path] = (),
    units: str = "mm",
    loop: bool = True,
    inspection: bool = True,
    progress: Progress = lambda station: None,
) -> Results:
    """Compare a scan with its design.

    Parameters
    ----------
    design : Design
        One gear or a pair.
    scans : sequence of path
        One scan, or several views of one gear.
    part : {"pinion", "gear"} or None
        Which one was scanned; None: the one whose size fits.
    before : sequence of path
        Scan of the same gear unworn, or its views.
    units : str
        Unit of the scans.
    loop : bool
        Whether to look for effects beyond registration.
    inspection : bool
        Whether to evaluate ISO 1328 deviations.
    progress : callable
        Told each station.

    Returns
    -------
    Results

    Raises
    ------
    InputError
        If a file or a value is wrong, or the scan is of something else.
    """
    progress("reading")
    read = read_scan(scans, units)
    name = part or _part_of(design, read)
    if name not in design.gears:
        raise InputError(f"--part {name}: the design has only {', '.join(design.gears)}")
    gear = design.gears[name]
    for scan in read:
        check_size(scan, gear)
    planar = read[0].kind == "section"

    progress("registration")
    placed = place([scan.points for scan in read], gear, [scan.normals for scan in read], planar)
    noise = placed.registration.noise
    grid = CellGrid.for_scan(gear, len(placed.located), planar=planar)
    first = bin_points(placed.located, grid, clip=stray_limit(placed.located))
    context = _context(first, placed, design, name, planar)

    found, pose, cells, located = None, placed.registration.pose, first, placed.located
    if loop:
        progress("closing the loop")
        found = close_loop(first, noise, context, placed.registration.datum.worn_side)
        if found.rms_before > DISTORTED * gear.transverse_module:
            # The bands were set before anything was known of the distortion; now each point can be judged by what is left.
            placed = replace(placed, located=_relocated(placed, found, gear))
            first = bin_points(placed.located, grid)
            found = close_loop(first, noise, context, placed.registration.datum.worn_side)
        located, pose = _moved(placed, found, gear)
        cells = bin_points(located, grid, clip=stray_limit(located))

    progress("wear")
    corrected, as_made, manufacture = _corrected(cells, found)
    scatter = noise
    if before:
        # What both scans share is design, manufacture and scanner; each scan's own measurement effects are taken out first.
        reference, reference_noise = _before(before, gear, design, name, units, grid, loop, progress)
        as_made = corrected.with_deviation(corrected.points.deviation - reference)
        scatter = float(np.hypot(noise, reference_noise))
    worn_side = placed.registration.datum.worn_side
    wear = find_wear(as_made, scatter, worn_side)
    wear_before = find_wear(first, noise, worn_side)
    laws = fit_laws(wear, grid, context)

    progress("thickness")
    thickness = _thickness(located, gear, noise, found, planar)

    progress("worn solid")
    worn = worn_profiles(grid, np.maximum(wear.depth, 0.0))  # noise may not add metal to the model
    solids = None if planar else _solids(worn)
    boolean = _plain_boolean(read, pose, gear, grid) if len(read) == 1 and not planar else None

    study = None
    if design.pair is not None:
        progress("meshing")
        study = _meshing(design, name, grid, wear, manufacture, thickness)
    inspected = None
    if inspection and not planar:
        progress("inspection")
        inspected = _inspect(located, gear, noise, found)
    notes = (*design.warnings, *placed.registration.notes)
    return Results(
        design, name, gear, tuple(read), placed, pose, found, cells, corrected, as_made, wear, wear_before, laws, thickness, worn,
        solids, study, inspected, boolean, notes, tuple(str(path) for path in before), manufacture,
    )  # fmt: skip


def _part_of(design: Design, scans: Sequence[Scan]) -> str:
    """The part whose tip circle comes nearest to the scan's reach."""
    if len(design.gears) == 1:
        return next(iter(design.gears))
    points = np.vstack([scan.points[:: 1 + len(scan) // 20000] for scan in scans])
    low, high = np.quantile(points, [0.001, 0.999], axis=0)
    reach = float(np.sort(high - low)[-1])
    return min(design.gears, key=lambda name: abs(np.log(reach / (2.0 * design.gears[name].tip_radius))))


def _context(cells: Cells, placed: PlacedScan, design: Design, part: str, planar: bool) -> Context:
    mate = design.mate_of(part)
    line = None
    if mate is not None:
        gear, centre = design.gears[part], design.centre_distance
        line = (mate.teeth / gear.teeth, float(np.sqrt(centre**2 - (gear.base_radius + mate.base_radius) ** 2)))
    return make_context(cells, placed.registration.pose.rotation, planar, line)


def _relocated(placed: PlacedScan, loop: Loop, gear: Gear) -> SurfacePoints:
    """The points of a strongly distorted scan on the design: taken from far, kept where the model explains them."""
    wide = Bands.wide(gear)
    far = Bands(*((3.0 * low, 3.0 * high) for low, high in (getattr(wide, f.name) for f in fields(wide))))
    found = locate(placed.measured, gear, far)
    known = np.flatnonzero(found.surface != OTHER)
    part = found.take(known)
    model = loop.deviation(part, MEASURED | MADE) + motion_columns(part.position, part.normal) @ loop.motion
    left = part.deviation - model
    limits = np.array([getattr(wide, name) for name in BAND_OF_SURFACE])[part.surface]
    off = (left < limits[:, 0]) | (left > limits[:, 1])
    surface, deviation = found.surface.copy(), found.deviation.copy()
    surface[known[off]], deviation[known[off]] = OTHER, np.nan
    return replace(found, surface=surface, deviation=deviation)


def _moved(placed: PlacedScan, loop: Loop, gear: Gear) -> tuple[SurfacePoints, Pose]:
    """The points located again after the small motion that the loop found together with its effects."""
    back = small_motion(-loop.motion)
    pose = placed.registration.pose.then(back)
    if loop.rms_before > DISTORTED * gear.transverse_module:
        # So far off the design that the bands would cut it: the small motion is taken off the deviations instead.
        found = placed.located
        return found.with_deviation(found.deviation - motion_columns(found.position, found.normal) @ loop.motion), pose
    return locate(back.apply(placed.measured), gear, placed.registration.bands), pose


def _corrected(cells: Cells, loop: Loop | None) -> tuple[Cells, Cells, Floats]:
    """Cells without measurement effects; also without manufacture and unexplained structure; and the manufacture on the wear sheets."""
    if loop is None:
        return cells, cells, np.zeros_like(make_sheets(cells).deviation)
    seen = cells.seen
    points = cells.points.take(seen)
    measured, made = np.zeros(len(seen)), np.zeros(len(seen))
    measured[seen], made[seen] = loop.deviation(points, MEASURED), loop.deviation(points, MADE)
    pattern = sum((p.field for p in loop.patterns), np.zeros(len(seen)))
    corrected = cells.with_deviation(cells.points.deviation - measured)
    as_made = cells.with_deviation(cells.points.deviation - measured - made - pattern)
    grid = cells.grid
    sheets = np.concatenate([grid.fillet_shape(made), grid.flank_shape(made)], axis=-1)
    return corrected, as_made, sheets


def _before(
    files: Sequence[str | Path], gear: Gear, design: Design, part: str, units: str, grid: CellGrid, loop: bool, progress: Progress
) -> tuple[Floats, float]:
    """Deviation of the unworn gear in every cell without that scan's measurement effects, mm; its noise, mm."""
    progress("scan before wear")
    read = read_scan(files, units)
    for scan in read:
        check_size(scan, gear)
    planar = read[0].kind == "section"
    placed = place([scan.points for scan in read], gear, [scan.normals for scan in read], planar)
    cells = bin_points(placed.located, grid, clip=stray_limit(placed.located))
    noise = placed.registration.noise
    if loop:
        found = close_loop(cells, noise, _context(cells, placed, design, part, planar), placed.registration.datum.worn_side)
        located, _ = _moved(placed, found, gear)
        cells, _, _ = _corrected(bin_points(located, grid, clip=stray_limit(located)), found)
    return np.nan_to_num(cells.points.deviation), noise


def _thickness(located: SurfacePoints, gear: Gear, noise: float, loop: Loop | None, planar: bool) -> SectionThickness:
    """Section thickness with measurement effects taken out; the loss against the as-made gear."""
    heights = np.array([0.5 * gear.face_width]) if planar else None
    if loop is None:
        return section_thickness(located, gear, noise, z=heights)
    own = located.roll + located.deviation
    near = located.take((located.surface == FLANK) & (np.abs(own - gear.reference_roll) < 0.5 * gear.transverse_module))
    near = near.with_deviation(near.deviation - loop.deviation(near, MEASURED))
    result = section_thickness(near, gear, noise, z=heights)
    tooth = np.repeat(np.arange(gear.teeth), len(result.z))
    z = np.tile(result.z, gear.teeth)
    roll = np.full(len(tooth), gear.reference_roll)
    left, right = (loop.deviation(flank_points(gear, tooth, np.full(len(tooth), side), roll, z), MADE) for side in (1, -1))
    arc = gear.reference_radius / gear.base_radius * (left + right).reshape(gear.teeth, -1)
    return result.against(result.nominal + arc)


def _solids(worn: ToothProfiles) -> Solids:
    triangles = gear_triangles(worn)
    bodies = worn_bodies(gear_triangles(nominal_like(worn)), triangles)
    return Solids(triangles, tuple(bodies))


def _plain_boolean(scans: Sequence[Scan], pose: Pose, gear: Gear, grid: CellGrid) -> PlainBoolean | None:
    """The boolean with the user's own triangles, where they are closed."""
    scan = scans[0]
    if scan.triangles is None or gear.spec.bore_diameter > 0.0:
        return None
    nominal = gear_triangles(worn_profiles(grid, np.zeros((gear.teeth, 2, grid.rows, grid.fillet + grid.flank))))
    try:
        removed, signed, pieces = signed_difference(nominal, Triangles(pose.apply(scan.points), scan.triangles))
    except InputError:
        return None  # not closed: the usual case for a scan, and no fault of the user's
    return PlainBoolean(removed, signed, pieces)


def _meshing(
    design: Design, part: str, grid: CellGrid, wear: Wear, manufacture: Floats, thickness: SectionThickness
) -> MeshingStudy:
    pair = design.pair
    assert pair is not None
    pinion, gear, centre = design.gears["pinion"], design.gears["gear"], design.centre_distance
    worst = max([tooth.greatest_loss for tooth in thickness.teeth() if tooth.seen] or [0.0])
    worst = max(worst, 0.0)
    real = worn_profiles(grid, np.maximum(wear.depth, 0.0) - manufacture)
    mate = design.gears["gear" if part == "pinion" else "pinion"]
    other = nominal_profiles(mate, np.linspace(mate.root_radius, mate.tip_radius, 200), np.array([0.5 * mate.face_width]))
    lost = {side: sum(r.volume for r in wear.regions if r.side == side) for side in (1, -1)}
    side = 1 if lost[1] >= lost[-1] else -1
    pair_of = (real, other) if part == "pinion" else (other, real)
    contact = mesh_contact(*pair_of, centre, LEFT if side > 0 else RIGHT, positions_per_pitch=34)
    published = published_meshing(pinion, gear, centre, worst, pair.backlash_allowance, pair.baseline)
    shafts = shaft_movement(pinion, gear, centre, worst) if worst > 0.0 else None
    return MeshingStudy(exact_meshing(pinion, gear, centre), published, contact, shafts, side)


def _inspect(located: SurfacePoints, gear: Gear, noise: float, loop: Loop | None) -> Inspection:
    if loop is not None:
        flank = located.take(located.surface == FLANK)
        located = flank.with_deviation(flank.deviation - loop.deviation(flank, MEASURED))
    return inspect(located, gear, Settings(noise=noise))
