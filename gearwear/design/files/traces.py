"""Traces of a gear measuring machine as a gear: the way in for those who have no scanner."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.files.toml import read_small
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles, section_radii, straight_weights
from gearwear.design.quantity import at_most
from gearwear.design.side import Side
from gearwear.design.twist import Toothing, refuse
from gearwear.errors import InputError

KINDS = ("profile", "helix", "pitch")
ALONG = ("roll_mm", "diameter_mm", "roll_angle_deg")
HEADER = f"kind, tooth, flank, one of {', '.join(ALONG)}, z_mm and deviation_um"
ROWS = 33
"""Heights of the flanks that are built."""
MOST_BYTES = 20_000_000
"""Of a file: 400,000 rows, which take half a gigabyte while they are read."""
MOST_TRACES = 1000
"""Of one kind on a flank: what two of them have at their crossing is kept for every pair."""
LARGEST_MM = 5.0
"""A deviation beyond this is in another unit."""


@dataclass(frozen=True, slots=True)
class MeasuredTrace:
    """One trace of one flank.

    Parameters
    ----------
    at : float
        z of a profile, L of a helix, mm.
    place, deviation : (n,) float
        L of a profile, z of a helix, rising, and δ along the transverse base tangent, mm.
    """

    at: float
    place: Floats
    deviation: Floats

    def __call__(self, where: Floats | float) -> Floats:
        """Deviation there, mm; beyond the ends as at them."""
        return np.asarray(np.interp(where, self.place, self.deviation))

    def raised(self, by: float) -> MeasuredTrace:
        return MeasuredTrace(self.at, self.place, self.deviation + by)


def read_traces(path: Path, design: Design) -> tuple[str, ToothProfiles]:
    """Read measured traces, as `gearwear inspect` writes them or as a measuring machine's export is easily turned into.

    Parameters
    ----------
    path : Path
        CSV with a header line; commas, semicolons or tabulators between, with the latter two the decimal sign may be a comma; lines that begin with # are
        skipped, columns of other names too. ``kind`` is profile, helix or pitch; ``tooth`` from 1; ``flank`` left or right; ``roll_mm``,
        ``diameter_mm`` or ``roll_angle_deg`` and ``z_mm`` say where (left out: mid-face for profiles, the reference circle for helices and pitch);
        ``deviation_um`` is along the transverse base tangent, + is more material, of a pitch the index, arc, + counter-clockwise. ``part``: pinion or
        gear, where the number of teeth leaves it open. Rows whose ``place`` is mean count where there are no others of their kind; else, where the
        rows state ``U_um`` (k = 2), the others count as far as they differ from the mean of their flank by more than that. Of a place, or a
        pitch, that is there several times the mean counts.
    design : Design
        The gear, or the pair it belongs to.

    Returns
    -------
    part : str
    profiles : ToothProfiles
        `measured` says which flanks had a profile.

    Raises
    ------
    InputError
        If a row is not understood (with its line), or there is no profile.

    Notes
    -----
    Profiles P_j(L) at z_j and helices H_i(z) at L_i make a Gordon surface: ``Σ ℓ_j(z) P_j + Σ m_i(L) H_i − ΣΣ ℓ_j m_i c_ij``, ℓ and m linear between
    neighbours and on beyond the outer ones, c_ij where the two cross. Machines set traces to a zero of their own: helices are raised to meet the profile
    nearest mid-face, and other profiles to meet the helices. With pitch rows each flank is then set to its index at that circle, tooth thickness as
    designed; without, its level is that of its profile. The fillet goes with the end of the flank, and less and less from its middle to the root: left where it
    is, the mate's tip would meet a step that nobody measured. A flank that was not measured is as the mean of those of its side.
    """
    needed = f"a CSV of traces with {HEADER}"
    try:
        text = read_small(path, needed, MOST_BYTES, usual="").decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not text in UTF-8; {needed} is needed") from None
    rows = list(_rows(path, text))
    part = _part(path, rows, design)
    gear = design.gears[part]
    refuse(gear, "what is measured on a machine", Toothing.DOUBLE_HELICAL)
    traces: dict[tuple[str, int, int], list[MeasuredTrace]] = {}
    indices: dict[tuple[int, int], list[tuple[float, float]]] = {}
    groups: dict[tuple[str, int, int, float], Points] = {}
    means: dict[tuple[str, int, int], Points] = {}
    lines = {row.kind for row in rows if row.words.get("place", "") != "mean"}
    for row in rows:
        tooth, side = row.flank(gear)
        roll = row.roll(gear, needed=row.kind == "profile")
        z = row.number("z_mm", needed=row.kind == "helix")
        deviation = 1e-3 * row.number("deviation_um")
        if abs(deviation) > LARGEST_MM:
            raise row.wrong(f"deviation_um {1e3 * deviation:g}", "µm")
        if row.kind == "pitch":
            indices.setdefault((tooth, side), []).append((roll, deviation))
            continue
        at, place = (z if math.isfinite(z) else 0.5 * gear.face_width, roll) if row.kind == "profile" else (roll, z)
        point = place, deviation, 0.5e-3 * row.number("u_um", needed=False)
        if row.kind in lines and row.words.get("place", "") == "mean":
            means.setdefault((row.kind, tooth, side), []).append(point)
        else:
            groups.setdefault((row.kind, tooth, side, round(at, 4)), []).append(point)
    for (kind, tooth, side, at), points in groups.items():
        trace = _rising(points)
        if len(trace) < 3:
            raise InputError(f"{path}: the {kind} of tooth {tooth + 1} {tuple(Side)[side]} has {len(trace)} points: 3 at least")
        of_flank = traces.setdefault((kind, tooth, side), [])
        of_flank.append(MeasuredTrace(at, trace[:, 0], _beyond_noise(trace, means.get((kind, tooth, side)))))
        if len(of_flank) > MOST_TRACES:
            raise InputError(
                f"{path}: the {tuple(Side)[side]} flank of tooth {tooth + 1} has more than {MOST_TRACES:,} traces of kind {kind}: one at each "
                "height, or at each place of the profile, would be right"
            )
    if not any(kind == "profile" for kind, *_ in traces):
        raise InputError(f"{path}: holds no profile; rows of kind profile would be right, with {HEADER}")
    index = {
        flank: (math.fsum(r for r, _ in seen) / len(seen), math.fsum(d for _, d in seen) / len(seen))
        for flank, seen in indices.items()
    }
    return part, _profiles(gear, traces, index)


Points = list[tuple[float, float, float]]
"""Place, deviation and its standard deviation (nan where it is not stated), mm."""


def _rising(points: Points) -> Floats:
    """The points (n, 3) by their places, each place once: what was measured there several times, as its mean."""
    table = np.array(points)
    place, of, times = np.unique(table[:, 0], return_inverse=True, return_counts=True)
    value, variance = np.bincount(of, table[:, 1]) / times, np.bincount(of, table[:, 2] ** 2) / times**2
    return np.column_stack([place, value, np.sqrt(variance)])


def _beyond_noise(trace: Floats, usual: Points | None) -> Floats:
    """Values of a trace (n, 3), mm, which departs from the mean trace of its flank, and from a straight line, as far as its noise lets that be told.

    A line of a scan holds the noise of a few points, and in contact its peaks would carry. Of the mean square d² of the departures, u² is expected of
    noise: the share ``1 − u² / d²`` of them is the trace's own (empirical Bayes; James and Stein 1961). Left as it is where no noise is stated.
    """
    where, values, std = trace.T
    if not np.isfinite(std).all():
        return np.asarray(values, dtype=np.float64)

    def own_share(apart: Floats, noise: float) -> float:
        return max(1.0 - noise / max(float((apart**2).mean()), 1e-300), 0.0)

    noise = float((std**2).mean())
    if usual is not None:
        place, mean, of_mean = _rising(usual).T
        level = np.interp(where, place, mean)
        level = level + float(np.mean(values - level))
        share = own_share(values - level, noise)
        values = level + share * (values - level)
        if np.isfinite(of_mean).all():  # what is left of the noise
            noise = share**2 * noise + (1.0 - share) ** 2 * float((of_mean**2).mean())
    slope, height = np.polyfit(where - where[0], values, 1)
    line = height + slope * (where - where[0])
    return np.asarray(line + own_share(values - line, noise) * (values - line), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class _Row:
    """One line of the file."""

    where: str
    words: dict[str, str]
    decimal_comma: bool

    @property
    def kind(self) -> str:
        return self.words["kind"]

    def wrong(self, mistake: str, right: str) -> InputError:
        return InputError(f"{self.where}: {mistake}: {right} would be right")

    def number(self, name: str, needed: bool = True) -> float:
        """nan where it is left out and may be."""
        word = self.words.get(name, "")
        if not word and not needed:
            return math.nan
        try:
            value = float(word.replace(",", ".") if self.decimal_comma else word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.wrong(f"{name} {word!r}", "a number")
        return value

    def flank(self, gear: Gear) -> tuple[int, int]:
        tooth, name = self.number("tooth"), self.words.get("flank", "").lower()
        if not (tooth.is_integer() and 1 <= tooth <= gear.teeth):
            raise self.wrong(f"tooth {tooth:g}", f"1 to {gear.teeth}")
        if name not in [str(side) for side in Side]:
            raise self.wrong(f"flank {name!r}", "left or right")
        return int(tooth) - 1, [str(side) for side in Side].index(name)

    def roll(self, gear: Gear, needed: bool) -> float:
        name = next((name for name in ALONG if self.words.get(name)), "")
        if not name:
            if needed:
                raise self.wrong("no place", f"one of {', '.join(ALONG)}")
            return gear.reference_roll
        value = self.number(name)
        if name == "diameter_mm":
            value = math.sqrt(max(0.25 * value**2 - gear.base_radius**2, 0.0))
        elif name == "roll_angle_deg":
            value = math.radians(value) * gear.base_radius
        most = max(gear.tip_roll, gear.form_roll)
        if not 0.0 <= value <= 1.2 * most:
            raise self.wrong(f"{name} {self.words[name]}", f"on the involute, L 0 to {at_most(1.2 * most, 3)} mm,")
        return value


def _rows(path: Path, text: str) -> Iterator[_Row]:
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    if not lines:
        raise InputError(f"{path}: is empty; a CSV of traces with {HEADER} would be right")
    separator = max(";\t,", key=lines[0][1].count)
    names = [name.strip().lower() for name in _cells(f"{path}:{lines[0][0]}", lines[0][1], separator)]
    for name in ("kind", "tooth", "flank", "deviation_um"):
        if name not in names:
            raise InputError(f"{path}: has no column {name}; {HEADER} would be right")
    for number, line in lines[1:]:
        values = _cells(f"{path}:{number}", line, separator)
        if len(values) > len(names):
            raise InputError(f"{path}: line {number} has {len(values)} cells and line {lines[0][0]} names {len(names)} columns")
        row = _Row(f"{path}:{number}", dict(zip(names, (value.strip() for value in values), strict=False)), separator != ",")
        if row.words.get("kind") not in KINDS:
            raise row.wrong(f"kind {row.words.get('kind', '')!r}", " or ".join(KINDS))
        yield row


def _cells(where: str, line: str, separator: str) -> list[str]:
    """Of one row."""
    try:
        return next(csv.reader([line], delimiter=separator))
    except csv.Error as error:
        raise InputError(f"{where}: is no row of a table ({error}); {HEADER} would be right") from None


def _part(path: Path, rows: list[_Row], design: Design) -> str:
    """Which gear of the design the traces are of."""
    said = {row.words["part"] for row in rows if row.words.get("part")}
    if len(said) > 1 or not said <= set(design.gears):
        raise InputError(f"{path}: part is {', '.join(sorted(said))}; one of {', '.join(design.gears)} would be right")
    if said:
        return said.pop()
    most = max((int(row.number("tooth")) for row in rows), default=0)
    fitting = [name for name, gear in design.gears.items() if most <= gear.teeth]
    if not fitting:
        raise InputError(f"{path}: has a tooth {most}; the design's gears have fewer teeth")
    if len(fitting) > 1:
        raise InputError(f"{path}: does not say of which gear it is; a column part with {' or '.join(fitting)} would be right")
    return fitting[0]


def _profiles(
    gear: Gear, traces: dict[tuple[str, int, int], list[MeasuredTrace]], index: dict[tuple[int, int], tuple[float, float]]
) -> ToothProfiles:
    """Half angles of all flanks."""
    radius = np.union1d(section_radii(gear), [gear.form_radius])
    roll = np.sqrt(np.maximum(radius**2 - gear.base_radius**2, 0.0))
    z = np.linspace(0.0, gear.face_width, ROWS)
    moved = np.full((gear.teeth, 2, ROWS, len(radius)), np.nan)
    for tooth, side in np.ndindex(gear.teeth, 2):
        profile = traces.get(("profile", tooth, side))
        if profile:
            moved[tooth, side] = flank_surface(profile, traces.get(("helix", tooth, side), []), 0.5 * gear.face_width)(roll, z)
    measured = np.isfinite(moved[:, :, 0, 0])
    for side in range(2):
        seen = measured[:, side]
        usual = moved[seen, side].mean(axis=0) if seen.any() else np.zeros((ROWS, len(radius)))
        moved[~seen, side] = usual
    orientation = gear.orientation
    middle, on_flank = ROWS // 2, orientation * radius >= orientation * gear.form_radius
    for (tooth, side), (circle, arc) in index.items():
        level = float(np.interp(circle, roll[on_flank], moved[tooth, side, middle, on_flank]))
        moved[tooth, side] += tuple(Side)[side] * arc * math.cos(gear.transverse_pressure_angle) - level
    from_root = orientation * np.array([gear.root_radius, 0.5 * (gear.root_radius + gear.form_radius)])
    kept = np.interp(orientation * radius, from_root, [0.0, 1.0])
    half = gear.half_angles(radius, z) + kept * moved / gear.base_radius
    return ToothProfiles(gear, radius, z, half, measured)


def flank_surface(
    profiles: list[MeasuredTrace], helices: list[MeasuredTrace], middle: float
) -> Callable[[Floats, Floats], Floats]:
    """The surface through the traces of a flank: a function of L (n,) and z (m,), mm, that gives δ, (m, n) mm; see `read_traces`."""
    profiles = sorted(profiles, key=lambda trace: trace.at)
    reference = min(profiles, key=lambda trace: abs(trace.at - middle))
    helices = [
        helix.raised(float(reference(helix.at) - helix(reference.at))) for helix in sorted(helices, key=lambda helix: helix.at)
    ]
    heights, rolls = (np.array([trace.at for trace in some]) for some in (profiles, helices))
    if helices:
        levels = np.mean([helix(heights) for helix in helices], axis=0)
        profiles = [
            profile if profile is reference else profile.raised(float(level - np.mean(profile(rolls))))
            for profile, level in zip(profiles, levels, strict=True)
        ]

    def surface(roll: Floats, z: Floats) -> Floats:
        over_z = straight_weights(heights, z)  # (m, j)
        along = np.stack([profile(roll) for profile in profiles])
        if not helices:
            return np.asarray(over_z @ along)
        over_roll = straight_weights(rolls, roll)  # (n, i)
        across = np.stack([helix(z) for helix in helices])
        crossing = 0.5 * (np.stack([profile(rolls) for profile in profiles]) + np.stack([helix(heights) for helix in helices]).T)
        return np.asarray(over_z @ along + (over_roll @ across).T - over_z @ crossing @ over_roll.T)

    return surface
