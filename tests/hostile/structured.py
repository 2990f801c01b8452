"""Structured cases: good files in which counts, lists, references, nesting, units and sizes are put to every bound ± 1.

Damage of bytes finds what a reader does with noise. Here a file stays one of its format and says something else: a word becomes a number at
a bound, a line comes a thousand times or not at all, a reference names its neighbour, an integer of a binary header is one too large.
"""

from __future__ import annotations

import gzip
import io
import json
import random
import re
import struct
import zipfile
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from gearwear.design import Gear, GearSpec
from tests.scan.writers import CLOUDS, SURFACES, ball, torus

BITS = (7, 8, 15, 16, 31, 32, 52, 53, 63, 64)
INTEGERS = [0, 1, 2, 3, 99, 100, 101, 110, 10**15 - 1, 10**15, 10**16, *(2**n + d for n in BITS for d in (-1, 0, 1))]
WORDS = [
    *map(str, INTEGERS), *(f"-{n}" for n in INTEGERS[1:]), "1e308", "-1e308", "1e309", "1e-320", "-0", "0.0", "nan", "inf", "-inf", "+5", "0x10", "1_0",
    "1" * 400, "1" * 5000, "9.9e9999", "", "''", '""', "\t", "true", "null", "mm", "furlong", "µm", "deg", "..", "/", "\\", "%s", "{}", "()", "[]", "a" * 3000,
    "é", "\u202e", "\ufeff", "<b>", "&amp;", "#", "//", ";", ",", "x", "list", "double", "char", "uchar", "foo",
]  # fmt: skip
"""What stands in place of a word."""
TOKEN = re.compile(rb"[^\s<>=\"',:\[\]{}]+")


def text(data: bytes, by: random.Random) -> bytes:
    """A text with a few words, or lines, put to other ends."""
    for _ in range(by.choice((1, 1, 1, 2, 3))):
        found = list(TOKEN.finditer(data, 0, 4000 if by.random() < 0.8 else len(data)))
        if not found:
            return data
        one = by.choice(found)
        match by.randrange(10):
            case 0:
                lines = data.split(b"\n")
                at = by.randrange(min(len(lines), 40))
                most = 2 + 300_000 // (1 + len(lines[at]))
                data = b"\n".join([*lines[:at], *[lines[at]] * min(by.choice((0, 2, 3, 300, 3000)), most), *lines[at + 1 :]])
            case 1:
                lines = data.split(b"\n")
                a, b = by.randrange(min(len(lines), 40)), by.randrange(len(lines))
                lines[a], lines[b] = lines[b], lines[a]
                data = b"\n".join(lines)
            case 2:
                data = (
                    data[: one.start()]
                    + by.choice((b"[", b"(", b"<a>", b"{", b'"', b"'")) * by.choice((1, 2, 200, 20_000))
                    + data[one.start() :]
                )
            case 3:
                other = by.choice(found)
                data = data[: one.start()] + other[0] + data[one.end() :]
            case 4 if one[0].isdigit():
                data = data[: one.start()] + str(int(one[0]) + by.choice((-1, 1))).encode() + data[one.end() :]
            case 5:
                data = (
                    data[: one.start()]
                    + (one[0] + by.choice((b" ", b".", b",", b"-"))) * by.choice((2, 60, 5000))
                    + data[one.end() :]
                )
            case _:
                data = data[: one.start()] + by.choice(WORDS).encode() + data[one.end() :]
    return data


def binary(data: bytes, by: random.Random, first: int = 0, last: int = 400) -> bytes:
    """A binary file with integers of its header at a bound, or of another length."""
    result = bytearray(data)
    for _ in range(by.choice((1, 1, 2, 3))):
        size = by.choice((1, 2, 4, 8))
        at = by.randrange(first, max(min(len(result), last) - size, first + 1))
        old = int.from_bytes(result[at : at + size], "little")
        new = by.choice((old + 1, old - 1, 2 * old, by.choice(INTEGERS), -by.choice(INTEGERS)))
        result[at : at + size] = (new % 256**size).to_bytes(size, by.choice(("little", "little", "big")))
    match by.randrange(8):
        case 0:
            return bytes(result[: by.randrange(1, len(result))])
        case 1:
            return bytes(result) + bytes(by.choice((1, 3, 4, 50, 5000)))
    return bytes(result)


def tree(value: Any, by: random.Random) -> Any:
    """A JSON tree with one or a few of its places put to other ends."""
    value = json.loads(json.dumps(value))
    for _ in range(by.choice((1, 1, 2, 3))):
        places: list[tuple[Any, Any]] = []
        todo = [value]
        while todo:
            one = todo.pop()
            keys = list(one) if isinstance(one, dict) else range(len(one)) if isinstance(one, list) else ()
            places += [(one, key) for key in keys]
            todo += [one[key] for key in keys]
        where, key = by.choice(places)
        match by.randrange(7):
            case 0:
                del where[key]
            case 1 if isinstance(where[key], list):
                where[key] = where[key] * by.choice((2, 100, 3000))
            case 2:
                deep: Any = where[key]
                for _ in range(by.choice((1, 2, 150))):
                    deep = [deep] if by.random() < 0.5 else {"children": deep}
                where[key] = deep
            case 3:
                other, its = by.choice(places)
                if its in (range(len(other)) if isinstance(other, list) else other):
                    where[key] = json.loads(json.dumps(other[its]))
            case _:
                where[key] = by.choice(
                    (by.choice(INTEGERS), -by.choice(INTEGERS), 0.5, 1e308, None, True, "", "x", [], {}, by.randrange(6))
                )
    return value


def _glb(by: random.Random) -> bytes:
    data = _whole("a.glb")
    if by.random() < 0.3:
        return binary(data, by, 0, 24)
    length = struct.unpack_from("<I", data, 12)[0]
    description = json.loads(data[20 : 20 + length])
    if by.random() < 0.5:
        description["nodes"] = [
            {"children": [1, 2], "scale": [1, 1, 1]},
            {"mesh": 0, "matrix": np.eye(4).ravel().tolist()},
            {"mesh": 0},
        ]
        description["scenes"] = [{"nodes": [0]}]
    changed = json.dumps(tree(description, by)).encode()
    changed += b" " * (-len(changed) % 4)
    rest = data[20 + length :]
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(changed) + len(rest), len(changed), b"JSON")
    return head + changed + rest


def _archive(data: bytes, by: random.Random, change: Callable[[str, bytes], bytes]) -> bytes:
    """A ZIP with one of its entries changed, or itself."""
    if by.random() < 0.15:
        return binary(data, by, 0, len(data))
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            for _ in range(by.choice((1,) * 30 + (0, 2))):
                new.writestr(name, change(name, old.read(name)))
    return out.getvalue()


COMPONENTS = b'</resources><build><item objectid="%s" transform="1 0 0 0 1 0 0 0 1 0 0 0"/></build>'


def _threemf(by: random.Random) -> bytes:
    def change(name: str, data: bytes) -> bytes:
        if not name.endswith("model"):
            return data
        first = re.search(rb'<object[^>]* id="(\d+)"', data) or re.search(rb'<object id="(\d+)"', data)
        if first and by.random() < 0.5:
            inner = b"".join(b'<object id="%d"><components>%s</components></object>' % (
                i, (b'<component objectid="%s"/>' % (first[1] if i == 900 else b"%d" % (i - 1))) * by.choice((1, 2, 10))
            ) for i in range(900, 900 + by.choice((1, 3, 30))))  # fmt: skip
            data = re.sub(rb"</(\w+:)?resources>.*</(\w+:)?build>", lambda _: inner + COMPONENTS % b"900", data, flags=re.DOTALL)
        return text(data, by)

    return _archive(_whole("a.3mf"), by, change)


def _crc32c(page: bytes) -> int:
    value = 0xFFFFFFFF
    for byte in page:
        value = CRC[(value ^ byte) & 255] ^ (value >> 8)
    return value ^ 0xFFFFFFFF


def _table() -> list[int]:
    rows = []
    for n in range(256):
        for _ in range(8):
            n = (n >> 1) ^ (0x82F63B78 if n & 1 else 0)
        rows.append(n)
    return rows


CRC = _table()


def mended(data: bytes) -> bytes:
    """An E57 whose pages have the sums of what is in them (CRC-32C, the last 4 of 1024 bytes)."""
    pages = [data[i : i + 1020] for i in range(0, len(data) - 1023, 1024)]
    return b"".join(page + _crc32c(page).to_bytes(4, "big") for page in pages)


def _e57(by: random.Random) -> bytes:
    data = bytearray(_whole("a.e57"))
    start = data.find(b"<?xml")
    if by.random() < 0.5:
        return mended(binary(bytes(data), by, 0, start if by.random() < 0.7 else len(data)).ljust(len(data), b"\0")[: len(data)])
    for _ in range(by.choice((1, 2, 3))):
        numbers = [m for m in re.finditer(rb"-?\d+|Float|Integer|double|single", data) if m.start() > start]
        one = by.choice(numbers)
        new = by.choice([b"0", b"1", b"9", b"-1", *(w.encode() for w in WORDS)])[: one.end() - one.start()].rjust(
            one.end() - one.start(), b"0"
        )
        data[one.start() : one.end()] = new
    return mended(bytes(data))


@cache
def _whole(name: str) -> bytes:
    return CLOUDS[name](ball(110)) if name in CLOUDS else SURFACES[name](*torus(12, 9))


def _of_text(name: str) -> Callable[[random.Random], bytes]:
    return lambda by: text(_whole(name), by)


def _of_header(name: str) -> Callable[[random.Random], bytes]:
    """The header is text, what follows is not."""

    def make(by: random.Random) -> bytes:
        data = _whole(name)
        end = next(
            (
                data.find(word) + len(word)
                for word in (b"end_header\n", b"DATA binary_compressed\n", b"DATA binary\n")
                if word in data
            ),
            0,
        )
        return text(data[:end], by) + (data[end:] if by.random() < 0.8 else binary(data[end:], by, 0, 100))

    return make


RICH_PLY = b"""ply
format ascii 1.0
comment made by hand
element history 2
property list uchar double numbers
element vertex 5
property float x
property float y
property float z
property list int int flags
property float nx
property float ny
property float nz
element face 2
property uchar kind
property list uchar int vertex_indices
end_header
1 1.5
2 2.5 3.5
0 0 0 1 7 0 0 1
1 0 0 0 0 0 1
0 1 0 2 7 8 0 0 1
1 1 0 0 0 0 1
2 1 0 0 0 0 1
1 3 0 1 2
1 4 0 1 3 2
"""

SCANS: dict[str, Callable[[random.Random], bytes]] = {
    **{
        name: _of_text(name)
        for name in ("text.ply", "a.xyz", "a.txt", "a.pts", "a.csv", "ascii.pcd", "text.stl", "a.obj", "a.off")
    },
    "rich.ply": lambda by: text(RICH_PLY, by),
    **{name: _of_header(name) for name in ("little.ply", "big.ply", "double.ply", "binary.pcd", "compressed.pcd", "a.ply")},
    "a.las": lambda by: binary(_whole("a.las"), by, 4, 375),
    "a.laz": lambda by: binary(_whole("a.laz"), by, 4, 480),
    "a.e57": _e57,
    "binary.stl": lambda by: binary(_whole("binary.stl"), by, 0, 140),
    "a.3mf": _threemf,
    "a.glb": _glb,
    "a.xyz.gz": lambda by: gzip.compress(text(_whole("a.xyz"), by) * by.choice((1, 1, 2, 400)))[
        : by.choice((None, None, -1, -9))
    ],
}
"""Cases by the name of the file."""

PAIR = b"""[pair]
centre_distance = 114.3
backlash_allowance = 0.2286
baseline = "zero_backlash"
[pinion]
teeth = 12
module = 6.35
pressure_angle = 20.0
face_width = 15.0
profile_shift = 0.0
addendum = 1.0
dedendum = 1.25
rack_tip_radius = 0.3
thinning = 0.0
bore_diameter = 20.0
tip_chamfer = 0.1
end_chamfer = 0.1
helix_angle = 0
internal = false
[gear]
teeth = 24
tip_diameter = 165.1
root_diameter = 136.525
[scanner]
axis_offset_mm = 0.5
noise_um = 10
scale_ppm_max = 500
"""
RING = b"""[pinion]
teeth = 17
normal_module = 1.5
helix_angle = 12.0
face_width = 10
addendum = 0.9
thinning = 0.05
bore_diameter = 8.0
[gear]
teeth = 48
internal = true
addendum = 0.75
profile_shift = 0.0
dedendum = 1.2
rim_diameter = 90.0
cutter_teeth = 25
cutter_tip_radius = 0.2
end_chamfer = 0.1
[gear.tolerance]
thickness = 0.02
[datum]
axis = "bore"
[load]
torque_Nm = 10
"""
"""A pinion in a ring, helical."""
BROACHED = b"""[gear]
teeth = 60
transverse_module = 2.0
internal = true
pressure_angle = 25
tip_diameter = 117.0
root_diameter = 125.0
face_width = 20
fillet_radius = 0.4
rim_diameter = 140.0
thinning = 0.05
"""
"""A ring alone, with its fillet drawn."""
DOUBLE = b"""[pair]
centre_distance = 93.6
[pinion]
teeth = 21
normal_module = 2.0
helix_angle = 30.0
face_width = 50
gap = 10.0
tip_chamfer = 0.1
[gear]
teeth = 60
helix_angle = -30.0
bore_diameter = 40
thinning = 0.1
[load]
load_per_width_N_mm = 100
"""
"""Both double helical."""
STATED = b"""[datum]
tooth_1_deg = 30.0
before_tooth_1_deg = -15
ignore = ["tip", "end_low"]
ignore_teeth = [3, 7]
ignore_z_mm = [[0.0, 1.5], [13, 15.0]]
axis = "teeth"
temperature_C = 24.5
material = "steel"
[load]
torque_Nm = 120.0
speed_rpm = 1500
elastic_modulus_MPa = 206000
poisson = 0.3
misalignment_um = 5
[limits]
wear_depth_mm = 0.2
wear_volume_mm3 = 100
thickness_loss_mm = 0.3
backlash_mm = 0.5
[gear.tolerance]
tip_diameter = 0.05
root_diameter = 0.1
face_width = 0.1
thickness = 0.05
profile_shift = 0.01
[report]
part_number = "A-1"
serial = 42
customer = "x"
operator = "y"
instrument = "z"
date = "2026-01-01"
remarks = "one"
logo = "logo.png"
[gear]
teeth = 24
module = 6.35
face_width = 15
tip_relief = 0.02
tip_relief_length = 3
helix_crowning = 0.01
end_relief = 0.01
end_relief_length = 1
[gear.left]
profile_crowning = 0.01
[pinion]
teeth = 12
"""
"""What a design says beside the teeth; last the teeth."""
TRACES = b"""part,kind,tooth,flank,roll_mm,z_mm,deviation_um
pinion,profile,1,left,0.5,7.5,-10
pinion,profile,1,left,12.0,7.5,-30
pinion,profile,1,left,26.5,7.5,-10
pinion,profile,2,right,0.5,,1.5
pinion,profile,2,right,12.0,,2.5
pinion,profile,2,right,26.5,,1.5
pinion,helix,1,left,12.0,1.0,-30
pinion,helix,1,left,12.0,7.5,-31
pinion,helix,1,left,12.0,14.0,-29
pinion,pitch,1,left,,,12
pinion,pitch,1,right,,,-12
"""
MANIFEST = b"""gear_id,inspected,design,scans,part,units,before,cycles_run,operator,repeat
g1,2026-01-01,a.toml,a.ply;b.ply,pinion,mm,,1e6,ann,1
g1,2026-02-01T10:00:00,a.toml,c.ply,pinion,in,a.ply;b.ply,2.5e6,bob,2
g2,,b.toml,d.ply,,,,,,
"""
TABLE = b"""key;value;unit
z;24;-
module;6,35;mm
face width;0,59;in
alpha;20;deg
x;0;-
ha*;1;mm
rho_f*;0,3;modules
bore;20;mm
pinion.z;12;-
pinion.b;15;mm
a;114,3;mm
"""
REXS = b"""<?xml version="1.0" encoding="UTF-8"?>
<model version="1.4" date="2026-01-01" applicationId="a"><relations>
<relation id="1" type="stage"><ref id="10" role="stage"/><ref id="11" role="gear_1"/><ref id="12" role="gear_2"/></relation>
<relation id="2" type="flank"><ref id="11" role="gear"/><ref id="13" role="left"/><ref id="14" role="right"/></relation>
<relation id="3" type="flank"><ref id="12" role="gear"/><ref id="15" role="left"/><ref id="15" role="right"/></relation>
<relation id="4" type="manufacturing_step"><ref id="13" role="workpiece"/><ref id="16" role="tool"/></relation>
</relations><components>
<component id="10" type="cylindrical_stage"><attribute id="center_distance" unit="mm">114.3</attribute></component>
<component id="11" type="cylindrical_gear" name="p"><attribute id="number_of_teeth" unit="none">12</attribute><attribute id="normal_module" unit="mm">6.35</attribute>
<attribute id="face_width" unit="mm">15</attribute><attribute id="tip_diameter" unit="mm">88.9</attribute></component>
<component id="12" type="cylindrical_gear" name="g"><attribute id="number_of_teeth" unit="none">24</attribute><attribute id="normal_module" unit="mm">6.35</attribute>
<attribute id="face_width" unit="m">0.015</attribute></component>
<component id="13" type="cylindrical_gear_flank"><attribute id="normal_pressure_angle" unit="deg">20</attribute></component>
<component id="14" type="cylindrical_gear_flank"><attribute id="addendum_modification_coefficient" unit="none">0</attribute></component>
<component id="15" type="cylindrical_gear_flank"><attribute id="normal_pressure_angle" unit="rad">0.34906585</attribute></component>
<component id="16" type="rack_shaped_tool"><attribute id="tip_radius_factor" unit="none">0.3</attribute></component>
</components></model>
"""
DESIGNS: dict[str, Callable[[random.Random], bytes]] = {
    "a.toml": lambda by: text(PAIR, by),
    "stated.toml": lambda by: text(STATED, by),
    "ring.toml": lambda by: text(RING, by),
    "broached.toml": lambda by: text(BROACHED, by),
    "double.toml": lambda by: text(DOUBLE, by),
    "table.csv": lambda by: text(TABLE.replace(b";", b",").replace(b"6,35", b"6.35") if by.random() < 0.3 else TABLE, by),
    "a.rexs": lambda by: text(REXS, by),
}
BAND = b"""[profile.left]
diameter_mm = [72, 80, 88]
lower_um = [-30, -10, -10]
upper_um = [0, 10, 10]
[profile.right]
roll_angle_deg = [5, 30]
lower_um = [-30, -10]
upper_um = [0, 10]
[helix]
z_mm = [1, 14]
lower_um = [-10, -10]
upper_um = [10, 10]
"""


def band(by: random.Random) -> bytes:
    """A file of K bands for the pair's pinion."""
    return text(BAND, by)


def traces(by: random.Random) -> bytes:
    """Traces of a measuring machine for the pair's pinion, with either separator."""
    return text(TRACES.replace(b",", b";") if by.random() < 0.3 else TRACES, by)


def manifest(by: random.Random) -> bytes:
    """A fleet."""
    return text(MANIFEST, by)


@cache
def _picture(format_: str) -> bytes:
    from PIL import Image

    out = io.BytesIO()
    Image.fromarray((np.indices((24, 40)).sum(axis=0) * 4).astype(np.uint8)).convert("RGB").save(out, format=format_)
    return out.getvalue()


def _png(by: random.Random) -> bytes:
    """A PNG whose chunks have other numbers, lengths, or places, with sums of what is in them; or sums that are wrong."""
    data = _picture("PNG")
    if by.random() < 0.2:
        return binary(data, by, 0, len(data))
    chunks, at = [], 8
    while at < len(data):
        length = int.from_bytes(data[at : at + 4], "big")
        chunks.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + length]))
        at += 12 + length
    for _ in range(by.choice((1, 1, 2, 3))):
        i = by.randrange(len(chunks))
        kind, inside = chunks[i]
        match by.randrange(5):
            case 0:
                chunks[i : i + 1] = [chunks[i]] * by.choice((0, 2, 300))
            case 1:
                chunks.insert(by.randrange(len(chunks)), chunks[i])
            case 2:
                chunks[i] = by.choice((b"IDAT", b"PLTE", b"tRNS", b"zTXt", b"iCCP", b"eXIf", b"acTL", b"xxxx")), inside
            case 3 if inside:
                chunks[i] = kind, inside[: by.randrange(len(inside))] + bytes(by.choice((0, 1, 5000)))
            case _ if inside:
                chunks[i] = kind, binary(inside, by, 0, 20)
        if not chunks:
            break
    return data[:8] + b"".join(
        struct.pack(">I", len(inside)) + kind + inside + struct.pack(">I", zlib.crc32(kind + inside)) for kind, inside in chunks
    )


LOGOS: dict[str, Callable[[random.Random], bytes]] = {
    "logo.png": _png,
    "logo.jpg": lambda by: binary(_picture("JPEG"), by, 0, 700),
}
"""Logos of a report by the name of the file."""


LISTED = b"""key,gear_id,inspected,design,scans,part,units,before,cycles_run,operator,repeat,limit_wear_depth_mm,limit_backlash_mm
g1_1,g1,2026-01-01,a.toml,a.ply;b.ply,pinion,mm,,1000000,ann,1,0.2,0.5
g1_2,g1,2026-02-01T10:00:00,a.toml,c.ply,pinion,in,a.ply;b.ply,2500000,bob,2,0.2,
g2_3,g2,,b.toml,d.ply,,mm,,,,,,
"""


def listed(by: random.Random) -> bytes:
    """A manifest as a store keeps it."""
    return text(LISTED, by)


@cache
def _numbers() -> bytes:
    from datetime import datetime

    from gearwear.fleet.tables import rows_parquet
    from tests.fleet.fleets import report, row

    return rows_parquet("g1_1", row("g1", datetime(2026, 1, 1), 1e6, "ann", "1"), report())


def numbers(by: random.Random) -> bytes:
    """A table of a store: its footer and its pages with other numbers."""
    data = _numbers()
    if by.random() < 0.5:
        return binary(data, by, max(len(data) - by.choice((8, 60, 3000)), 0), len(data))
    return binary(data, by, 0, len(data))


@cache
def _profiles() -> dict[str, np.ndarray]:
    gear = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    radius = np.linspace(gear.root_radius, gear.tip_radius, 12)
    half_angle = np.broadcast_to(gear.half_angle(radius), (12, 2, 3, 12)).copy()
    return {"radius": radius, "z": np.array([0.0, 7.0, 15.0]), "half_angle": half_angle, "part": np.array("pinion")}


def profiles(by: random.Random) -> bytes:
    """`worn_profiles.npz` of the pair's pinion: values, shapes, types and headers."""
    arrays = dict(_profiles())
    key = by.choice(list(arrays))
    value = arrays[key]
    if value.dtype.kind == "f":
        match by.randrange(6):
            case 0:
                value = value * by.choice((-1.0, 0.0, 0.5, 2.0, 50.0, 1e300, np.inf, np.nan))
            case 1:
                value = value.copy()
                value.flat[by.randrange(value.size)] = by.choice((-1e308, 1e308, np.nan, np.inf, 0.0, -1.0, 100.0))
            case 2:
                value = value[by.choice((slice(1), slice(0), slice(None, None, -1), slice(None, -1)))]
            case 3:
                value = by.choice((value.T, value[None], value.ravel(), np.repeat(value, 2, axis=-1), np.zeros((), float)))
            case 4:
                value = value.astype(by.choice(("f2", "f4", "c16", "U8", ">f8", "i8", "?")))
    else:
        value = by.choice(
            (np.array("gear"), np.array("é" * 100), np.array(["pinion"]), np.array(1.0), np.array(b"pinion"), np.array(""))
        )
    arrays[key] = value
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)  # type: ignore[arg-type]
    if by.random() < 0.6:
        return out.getvalue()

    def change(name: str, data: bytes) -> bytes:
        end = data.find(b"\n") + 1
        head = text(data[10 : end - 1].rstrip(), by) if by.random() < 0.5 else data[10 : end - 1]
        head = head.rstrip()
        head += b" " * (-(len(head) + 11) % 64) + b"\n"
        return data[:8] + struct.pack("<H", len(head) % 65536) + head + data[end:]

    return _archive(out.getvalue(), by, change)


def store_with(file: Path) -> Path:
    """The folder of a fleet round a case, its manifest or a table: all else in it is right."""
    folder = file.parent if file.suffix == ".parquet" else file.parent.parent
    (folder / "manifests").mkdir(exist_ok=True)
    others = {"manifests/listed.csv": LISTED, "g1_1.parquet": _numbers(), "g1_1.json": b"{}", "g1_2.refused": b"not so"}
    for name, data in others.items():
        if folder / name != file:
            (folder / name).write_bytes(data)
    return folder


def read_store(file: Path) -> None:
    """All that trend and gauge take from it."""
    from gearwear.fleet.reading import gauge_studies, read_fleet, trends
    from gearwear.fleet.store import Store

    fleet = read_fleet(Store(store_with(file)))
    trends(fleet)
    gauge_studies(fleet)


STORES: dict[str, Callable[[random.Random], bytes]] = {"manifests/listed.csv": listed, "g1_1.parquet": numbers}
"""Files of a fleet's store by their place in it."""
