"""The 3-D view: traces for plotly.js, written by hand; and the same as a still picture for print."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.report.figures.colours import DIVERGING, INK, LOST, UNSEEN, ColourScale
from gearwear.report.figures.surfaces import SurfaceTriangles
from gearwear.wear.regions import WearRegion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METAL = "#c9ced3"
LIGHT = {"ambient": 0.82, "diffuse": 0.3, "specular": 0.05, "roughness": 0.9, "fresnel": 0.02, "vertexnormalsepsilon": 1e-12}
AZIMUTH_OFF, ELEVATION = math.radians(52.0), math.radians(33.0)


def eye_direction(regions: Sequence[WearRegion], gear: Gear) -> Floats:
    """(3,) unit vector from the gear to the viewer: the flank that lost most is seen, from outside and a little above."""
    tooth, side = (regions[0].tooth, regions[0].side) if regions else (0, Side.LEFT)
    azimuth = tooth * gear.pitch_angle + side * AZIMUTH_OFF
    return np.array([math.cos(azimuth) * math.cos(ELEVATION), math.sin(azimuth) * math.cos(ELEVATION), math.sin(ELEVATION)])


def scene(
    nominal: list[SurfaceTriangles], worn: list[SurfaceTriangles], lost: SurfaceTriangles | None, scale: ColourScale, eye: Floats
) -> dict[str, Any]:
    """What plotly.js draws.

    Parameters
    ----------
    nominal, worn : list of SurfaceTriangles
        `surfaces.gear_surfaces`.
    lost : SurfaceTriangles or None
        `surfaces.worn_volume`.
    scale : ColourScale
        For the deviations.
    eye : (3,) float
        Direction to the viewer.

    Returns
    -------
    dict
        ``data`` (traces), ``layout``, and ``groups``: trace numbers by "worn", "lost" and "nominal".
    """
    data: list[dict[str, Any]] = []
    groups: dict[str, list[int]] = {"worn": [], "lost": [], "nominal": []}

    def add(group: str, trace: dict[str, Any]) -> None:
        groups[group].append(len(data))
        data.append(trace)

    for piece in worn:
        seen, unseen = _split(piece)
        if seen is not None:
            add("worn", _coloured(seen, scale, bar=not any("colorbar" in trace for trace in data)))
        if unseen is not None:
            add("worn", _plain(unseen, UNSEEN if piece.deviation_um is not None else METAL, 1.0, _grey_label(piece)))
    if lost is not None:
        add("lost", _plain(lost, LOST, 1.0, "lost metal") | {"visible": False})
    for piece in nominal:
        add("nominal", _plain(piece, "#8fa0b0", 0.22, f"{piece.name} of the design") | {"visible": False, "hoverinfo": "skip"})
    corners = np.concatenate([piece.vertices for piece in [*worn, *nominal]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    ratio = (high - low) / (high - low)[:2].max()
    axes = {
        f"{name}axis": {"visible": False, "range": [float(a), float(b)]} for name, a, b in zip("xyz", low, high, strict=True)
    }  # fmt: skip
    layout = {
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "font": {"family": "system-ui, sans-serif", "size": 12, "color": INK},
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": "#8a939b", "activecolor": INK},
        "hoverlabel": {"bgcolor": "#ffffff", "bordercolor": "#5a646e", "font": {"color": INK}},
        "scene": {
            # Room for the legend whether it is shown or not, so that the gear stays where it is.
            "domain": {"x": [0.0, 0.83], "y": [0.0, 1.0]}, **axes, "aspectmode": "manual", "aspectratio": dict(zip("xyz", ratio.tolist(), strict=True)), "dragmode": "orbit",
            "camera": {"eye": dict(zip("xyz", (1.34 * eye).tolist(), strict=True)), "up": {"x": 0, "y": 0, "z": 1}, "center": {"x": 0, "y": 0, "z": -0.07}},
        },
    }  # fmt: skip
    return {"data": data, "layout": layout, "groups": groups}


def _grey_label(piece: SurfaceTriangles) -> str:
    return f"{piece.name}, not seen" if piece.deviation_um is not None else piece.name


def _split(piece: SurfaceTriangles) -> tuple[SurfaceTriangles | None, SurfaceTriangles | None]:
    """Faces whose three corners were seen, and the others."""
    if piece.deviation_um is None:
        return None, piece
    whole = np.isfinite(piece.deviation_um)[piece.faces].all(axis=1)
    return _part(piece, piece.faces[whole]), _part(piece, piece.faces[~whole])


def _part(piece: SurfaceTriangles, faces: Ints) -> SurfaceTriangles | None:
    if not len(faces):
        return None
    used, index = np.unique(faces, return_inverse=True)
    found = None if piece.deviation_um is None else piece.deviation_um[used]
    return SurfaceTriangles(piece.name, piece.vertices[used], index.reshape(-1, 3), piece.tooth[used], found)


def _packed(values: Floats | Ints, dtype: str) -> dict[str, str]:
    """Typed array as plotly.js reads it: a third of the size of decimal text."""
    array = np.ascontiguousarray(values, dtype=np.dtype(dtype).newbyteorder("<"))
    packed = {"dtype": dtype, "bdata": base64.b64encode(array.tobytes()).decode("ascii")}
    if array.ndim == 2:
        packed["shape"] = f"{array.shape[0]}, {array.shape[1]}"
    return packed


def _trace(piece: SurfaceTriangles) -> dict[str, Any]:
    kind = "u2" if len(piece.vertices) < 65536 else "u4"
    trace: dict[str, Any] = {
        "type": "mesh3d",
        "name": piece.name,
        "lighting": LIGHT,
        "lightposition": {"x": 1e4, "y": 2e4, "z": 6e4},
    }
    for axis, key in enumerate("xyz"):
        trace[key] = _packed(piece.vertices[:, axis], "f4")
    for corner, key in enumerate("ijk"):
        trace[key] = _packed(piece.faces[:, corner], kind)
    return trace


def _coloured(piece: SurfaceTriangles, scale: ColourScale, bar: bool) -> dict[str, Any]:
    assert piece.deviation_um is not None
    radius = np.hypot(piece.vertices[:, 0], piece.vertices[:, 1])
    trace = _trace(piece) | {
        "intensity": _packed(scale.fraction(piece.deviation_um), "f4"),
        "cmin": -1.0, "cmax": 1.0, "cmid": 0.0,
        "colorscale": [[i / (len(DIVERGING) - 1), colour] for i, colour in enumerate(DIVERGING)],
        "showscale": bar,
        "customdata": _packed(np.stack([piece.tooth, radius, piece.deviation_um], axis=1), "f4"),
        "hovertemplate": (
            f"tooth %{{customdata[0]:d}} · {piece.name}<br>r %{{customdata[1]:.2f}} mm · z %{{z:.2f}} mm"
            "<br><b>%{customdata[2]:+.1f} µm</b><extra></extra>"
        ),
    }  # fmt: skip
    if bar:
        trace["colorbar"] = {
            "title": {"text": "deviation, µm<br>+ too much<br>− missing<br>&nbsp;", "side": "top"}, "thickness": 14, "len": 0.86, "x": 0.84,
            "tickvals": scale.fraction(np.array(scale.ticks_um)).tolist(), "ticktext": list(scale.tick_labels), "outlinewidth": 0,
        }  # fmt: skip
    return trace


def _plain(piece: SurfaceTriangles, colour: str, opacity: float, label: str) -> dict[str, Any]:
    trace = _trace(piece) | {"color": colour, "opacity": opacity, "hovertemplate": f"{label}<extra></extra>"}
    return trace | {
        "customdata": _packed(piece.tooth[:, None], "f4"),
        "hovertemplate": f"tooth %{{customdata[0]:d}} · {label}<br>z %{{z:.2f}} mm<extra></extra>",
    }


def still(axis: Axes, pieces: list[SurfaceTriangles], scale: ColourScale, eye: Floats) -> Axes:
    """The gear as a still picture: far triangles first, shaded, seen from far away.

    Parameters
    ----------
    axis : Axes
        Where to draw; its frame is removed.
    pieces : list of SurfaceTriangles
        What is seen.
    scale : ColourScale
        For the deviations.
    eye : (3,) float
        Direction to the viewer.

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
        corner = piece.vertices[piece.faces]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        length = np.linalg.norm(normal, axis=1)
        front = (normal @ eye > 0.0) & (length > 0.0)
        corner, normal = corner[front], normal[front] / length[front, None]
        base = np.tile(to_rgb(LOST if piece.name == "lost metal" else METAL), (len(corner), 1))
        if piece.deviation_um is not None:
            found = piece.deviation_um[piece.faces[front]].mean(axis=1)
            seen = np.isfinite(found)
            base[:] = to_rgb(UNSEEN)
            base[seen] = cmap(0.5 + 0.5 * scale.fraction(found[seen]))[:, :3]
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
    axis.autoscale_view()
    axis.set(aspect="equal")
    axis.set_axis_off()
    return axis
