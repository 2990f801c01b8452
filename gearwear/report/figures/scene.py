"""The 3-D view: surfaces, values and labels for the page's viewer; and the same as a still picture for print."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.report.figures.colours import DIVERGING, INK, LOST, UNSEEN, ColourScale
from gearwear.report.figures.surfaces import SurfaceTriangles
from gearwear.report.figures.views import ColouredGear
from gearwear.wear.regions import WearRegion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METAL, NOMINAL = "#c9ced3", "#8fa0b0"
AZIMUTH_OFF, ELEVATION = math.radians(52.0), math.radians(33.0)
LABEL_AWAY = 0.05
"""How far outside the tip circle a tooth's number stands, in tip radii."""
FINEST_UM, UNKNOWN = 0.1, -32768
"""Values are packed as whole numbers of at least so many micrometres; the number that stands for not seen."""


def eye_direction(regions: Sequence[WearRegion], gear: Gear) -> Floats:
    """(3,) unit vector from the gear to the viewer: the flank that lost most is seen, from outside, that of a ring across it, and a little above."""
    tooth, side = (regions[0].tooth, regions[0].side) if regions else (0, Side.LEFT)
    azimuth = tooth * gear.pitch_angle + side * (math.pi - AZIMUTH_OFF if gear.spec.internal else AZIMUTH_OFF)
    return np.array([math.cos(azimuth) * math.cos(ELEVATION), math.sin(azimuth) * math.cos(ELEVATION), math.sin(ELEVATION)])


def scene(
    views: Sequence[ColouredGear], nominal: Sequence[SurfaceTriangles], lost: SurfaceTriangles | None, eye: Floats, gear: Gear
) -> dict[str, Any]:
    """What the viewer draws.

    Parameters
    ----------
    views : sequence of ColouredGear
        The worn gear, coloured by one thing or another; the first is shown first. All have the same surfaces.
    nominal : sequence of SurfaceTriangles
        `surfaces.gear_surfaces` of the design.
    lost : SurfaceTriangles or None
        `surfaces.worn_volume`.
    eye : (3,) float
        Direction to the viewer.
    gear : Gear
        The design of the scanned gear.

    Returns
    -------
    dict
        ``surfaces`` (with group "worn", "lost" or "design"), ``views``, ``labels``, ``eye``, ``box``, ``colours``.
    """
    worn = views[0].pieces
    corners = np.concatenate([piece.vertices for piece in [*worn, *nominal]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    surfaces = []
    for i, piece in enumerate(worn):
        values = {view.key: view.pieces[i].deviation_um for view in views}
        surfaces.append(
            _surface(piece, "worn", METAL, low, high) | {"values": {k: _values(v) for k, v in values.items() if v is not None}}
        )
    if lost is not None:
        surfaces.append(_surface(lost, "lost", LOST, low, high))
    surfaces += [_surface(piece, "design", NOMINAL, low, high) for piece in nominal]
    return {
        "surfaces": surfaces,
        "views": [
            {
                "key": view.key, "label": view.label, "title": view.title, "words": view.words,
                "low": -1.0, "high": view.high, "limit": view.scale.limit_um, "linear": view.scale.linear_um, "ticks": view.ticks,
            }
            for view in views
        ],
        "labels": tooth_labels(worn, gear),
        "faceWidth": gear.face_width,
        "eye": eye.tolist(),
        "box": [low.tolist(), high.tolist()],
        "colours": {"scale": list(DIVERGING), "unseen": UNSEEN, "inside": NOMINAL},
    }  # fmt: skip


def tooth_labels(worn: Sequence[SurfaceTriangles], gear: Gear) -> list[dict[str, Any]]:
    """The number of every tooth, and where it stands: outside its tip, at the upper end."""
    tip = next(piece for piece in worn if piece.name == "tip")
    labels = []
    for tooth in range(1, gear.teeth + 1):
        corners = tip.vertices[tip.tooth == tooth]
        x, y, _ = corners[corners[:, 2] > corners[:, 2].max() - 1e-9].mean(axis=0)
        at = (1.0 + gear.orientation * LABEL_AWAY) * gear.tip_radius / math.hypot(x, y)
        labels.append({"text": str(tooth), "at": [at * x, at * y, gear.face_width]})
    return labels


def _surface(piece: SurfaceTriangles, group: str, colour: str, low: Floats, high: Floats) -> dict[str, Any]:
    """A surface, its corners as whole parts of the box: a seventh of the size of decimal text, and within 1 µm for a gear of 130 mm."""
    step = (high - low) / 65535.0
    starts = np.flatnonzero(np.diff(piece.tooth, prepend=-1))
    once, times = _repeated(piece.faces, starts)
    kind = "u2" if once.max() < 65536 else "u4"
    return {
        "name": piece.name, "group": group, "colour": colour, "faceted": group == "lost",
        "corners": _packed(np.rint((piece.vertices - low) / np.where(step > 0.0, step, 1.0)), "u2"),
        "faces": {"kind": kind, "times": times, "further": len(piece.vertices) // times} | _packed(once, kind),
        "teeth": [[int(start), int(piece.tooth[start])] for start in starts],
    }  # fmt: skip


def _repeated(faces: Ints, starts: Ints) -> tuple[Ints, int]:
    """Faces of one tooth and how many teeth have the same; all faces and 1 where they differ. Corners of the teeth begin at `starts`."""
    times = len(starts)
    if len(faces) % times or (np.diff(starts, n=2) != 0).any():
        return faces, 1
    each = faces.reshape(times, -1, 3)
    return (each[0], times) if (each == each[0] + starts[:, None, None]).all() else (faces, 1)


def _values(um: Floats) -> dict[str, Any]:
    seen = np.isfinite(um)
    step = max(FINEST_UM, float(np.abs(um[seen]).max(initial=0.0)) / 32767.0)
    return {"step": step} | _packed(np.where(seen, np.rint(np.where(seen, um, 0.0) / step), UNKNOWN), "i2")


def _packed(values: Floats | Ints, kind: str) -> dict[str, str]:
    array = np.ascontiguousarray(values).astype(np.dtype(kind).newbyteorder("<"))
    return {"data": base64.b64encode(array.tobytes()).decode("ascii")}


def still(
    axis: Axes, pieces: Sequence[SurfaceTriangles], scale: ColourScale, eye: Floats, labels: Sequence[dict[str, Any]] = ()
) -> Axes:
    """The gear as a still picture: far triangles first, shaded, seen from far away.

    Parameters
    ----------
    axis : Axes
        Where to draw; its frame is removed.
    pieces : sequence of SurfaceTriangles
        What is seen.
    scale : ColourScale
        For the deviations.
    eye : (3,) float
        Direction to the viewer.
    labels : sequence of dict
        `tooth_labels`; those on the far side are left out where the gear hides them.

    Returns
    -------
    Axes
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    from gearwear.report.figures.maps import colours as diverging

    right = np.cross([0.0, 0.0, 1.0], eye)
    right /= np.linalg.norm(right)
    view = np.stack([right, np.cross(eye, right), eye], axis=1)
    lamp = view @ (np.array([-0.35, 0.55, 0.76]))
    cmap = diverging()
    flat, depth, colours = [], [], []
    for piece in pieces:
        corner, front, normal = _facing(piece, eye)
        base = np.tile(to_rgb(LOST if piece.name == "lost metal" else METAL), (len(corner), 1))
        if piece.deviation_um is not None:
            deviation = piece.deviation_um[piece.faces[front]].mean(axis=1)
            seen = np.isfinite(deviation)
            base[:] = to_rgb(UNSEEN)
            base[seen] = cmap(0.5 + 0.5 * scale.fraction(deviation[seen]))[:, :3]
        shade = 0.66 + 0.38 * np.clip(normal @ lamp, 0.0, 1.0)
        flat.append(corner @ view[:, :2])
        depth.append((corner @ eye).mean(axis=1))
        colours.append(np.clip(base * shade[:, None], 0.0, 1.0))
    order = np.argsort(np.concatenate(depth))
    colour = np.concatenate(colours)[order]
    # Edges in the colour of their face close the hairlines between neighbours.
    outlines: Any = np.concatenate(flat)[order]  # matplotlib takes an array at once, though its types do not say so
    axis.add_collection(PolyCollection(outlines, facecolors=colour, edgecolors=colour, linewidths=0.3), autolim=False)
    axis.update_datalim(outlines.reshape(-1, 2))
    for label in labels:
        x, y = np.array(label["at"]) @ view[:, :2]
        if eye[2] > 0.5 or np.array([*label["at"][:2], 0.0]) @ eye > 0.0:
            axis.text(x, y, label["text"], fontsize=8, color=INK, ha="center", va="center")
    axis.autoscale_view()
    axis.set(aspect="equal")
    axis.set_axis_off()
    return axis


def _facing(piece: SurfaceTriangles, eye: Floats) -> tuple[Floats, Bools, Floats]:
    """Corners of the triangles that face the viewer, which these are, and their normals."""
    corner = piece.vertices[piece.faces]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.linalg.norm(normal, axis=1)
    front = (normal @ eye > 0.0) & (length > 0.0)
    return corner[front], front, normal[front] / length[front, None]
