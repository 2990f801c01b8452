import math

import pytest

from gearwear.design import Baseline, parse_design, read_design
from gearwear.design.files.writing import design_text
from gearwear.errors import InputError

PAPER = """
[pair]
centre_distance = 114.3
backlash_allowance = 0.2286
baseline = "with_allowance"

[pinion]
teeth = 12
module = 6.35
face_width = 15.0

[gear]
teeth = 24
rack_tip_radius = 0.38
"""


def _write(folder, text, name="design.toml"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def _refused(data, message):
    with pytest.raises(InputError, match=message):
        parse_design(data)


GEAR = {"teeth": 20, "module": 2.0, "face_width": 10.0}


def test_a_pair(tmp_path):
    path = _write(tmp_path, PAPER)
    design = read_design(path)
    assert design.source == str(path)
    assert design.pair is not None
    assert (design.pair.centre_distance, design.pair.backlash_allowance) == (114.3, 0.2286)
    assert design.pair.baseline is Baseline.WITH_ALLOWANCE
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    assert (pinion.teeth, gear.teeth) == (12, 24)
    assert gear.spec.normal_module == 6.35  # what a pair must share
    assert (pinion.spec.rack_tip_radius, gear.spec.rack_tip_radius) == (0.30, 0.38)  # what it need not
    assert gear.face_width == 15.0


def test_defaults_of_the_file_format():
    (gear,) = parse_design({"gear": GEAR}).gears.values()
    spec = gear.spec
    assert (spec.profile_shift, spec.addendum, spec.dedendum, spec.rack_tip_radius) == (0.0, 1.0, 1.25, 0.30)
    assert (spec.thinning, spec.bore_diameter, spec.tip_chamfer, spec.end_chamfer) == (0.0, 0.0, 0.0, 0.0)
    assert math.degrees(spec.normal_pressure_angle) == pytest.approx(20.0, rel=1e-15)


def test_a_gear_alone_has_no_pair():
    for part in ("pinion", "gear"):
        design = parse_design({part: GEAR})
        assert list(design.gears) == [part]
        assert design.pair is None
    _refused({"gear": GEAR, "pair": {}}, r"\[pair\] needs both \[pinion\] and \[gear\]")


def test_diametral_pitch_is_teeth_per_inch():
    gear = parse_design({"gear": {"teeth": 12, "diametral_pitch": 4, "face_width": 15}}).gears["gear"]
    assert gear.spec.normal_module == 6.35
    assert 2 * gear.reference_radius == pytest.approx(3 * 25.4, rel=1e-15)


def test_a_module_in_one_table_and_a_diametral_pitch_in_the_other():
    tables = {"pinion": {"teeth": 12, "module": 6.35, "face_width": 15}, "gear": {"teeth": 24, "diametral_pitch": 4}}
    assert parse_design(tables).gears["gear"].spec.normal_module == 6.35


@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_diameters_in_place_of_addendum_and_dedendum(shift):
    data = {**GEAR, "profile_shift": shift, "tip_diameter": 44.6, "root_diameter": 35.8}
    gear = parse_design({"gear": data}).gears["gear"]
    assert 2 * gear.tip_radius == pytest.approx(44.6, rel=1e-14)
    assert 2 * gear.root_radius == pytest.approx(35.8, rel=1e-14)
    _refused({"gear": {**data, "addendum": 1.0}}, "tip_diameter and addendum are both given")
    _refused({"gear": {**data, "dedendum": 1.0}}, "root_diameter and dedendum are both given")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"helix_angle": "15"}, "helix_angle = '15': must be a number"),
        ({"helix_angle": 75}, "helix_angle = 75 degrees: must lie from -60 to 60"),
        ({"transverse_module": 3}, "module and transverse_module are both given"),
        ({"internal": "yes"}, "internal = 'yes': true for a ring or false"),
        ({"teeth": -40}, "teeth = -40: must be above 0; a ring"),
        ({"teeth": 12.5}, r"teeth = 12\.5: must be a whole number"),
        ({"teeth": "12"}, "teeth = '12': must be a whole number"),
        ({"teeth": True}, "teeth = True: must be a whole number"),
        ({"module": "2"}, "module = '2': must be a number"),
        ({"module": math.nan}, "module = nan: must be a finite number"),
        ({"module": 0}, "module = 0 mm"),
        ({"diametral_pitch": 4}, "module and diametral_pitch are both given"),
        ({"face_width": [10]}, r"face_width = \[10\]: must be a number"),
        ({"face_width": 10**400}, "face_width = 1000.*: must be a finite number"),
        ({"modul": 2}, r"modul is unknown \(module\?\)"),
        ({"Face_Width": 2}, r"Face_Width is unknown \(face_width\?\)"),
        ({"colour": 2}, "colour is unknown; known are"),
        ({"a\nb": 2}, r"'a\\nb' is unknown"),
    ],
)
def test_wrong_values_are_named(change, message):
    _refused({"gear": {**GEAR, **change}}, rf"^\[gear\] {message}")


@pytest.mark.parametrize("key", ["helix_angle", "internal"])
def test_a_spur_gear_may_say_that_it_is_one(key):
    assert parse_design({"gear": {**GEAR, key: {"helix_angle": 0.0, "internal": False}[key]}}).gears


@pytest.mark.parametrize("missing", ["teeth", "module", "face_width"])
def test_missing_values_are_named(missing):
    _refused({"gear": {k: v for k, v in GEAR.items() if k != missing}}, rf"^\[gear\] {missing} is missing")


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        ({"centre_distance": "wide"}, "centre_distance = 'wide': must be a number"),
        ({"centre_distance": 0.0}, "centre_distance = 0 mm"),
        ({"backlash_allowance": -0.1}, r"backlash_allowance = -0\.1 mm"),
        ({"baseline": "cad"}, "baseline = 'cad': must be one of zero_backlash, with_allowance, pre_wear_scan"),
        ({"baseline": ["cad"]}, "baseline = "),
        ({"center_distance": 114.3}, "center_distance is unknown"),
    ],
)
def test_wrong_pair_values_are_named(pair, message):
    _refused({"pinion": GEAR, "gear": GEAR, "pair": pair}, rf"^\[pair\] {message}")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({}, r"neither \[pinion\] nor \[gear\]"),
        (
            {"gear": GEAR, "limits": {"wear_depth_mm": 60}},
            r"\[limits\] wear_depth_mm = 60: more than the pitch of .* of µm 0\.06 would",
        ),
        ({"wheel": GEAR}, r"\[wheel\] is unknown; known are pair, pinion, gear, scanner, datum, load, limits"),
        ({"gear": 3}, r"gear = 3: must be a table, written \[gear\]"),
        ({"gear": [GEAR]}, r"gear = .*: must be a table"),
        ({"gear": GEAR, "scanner": {"lens": 1.0}}, r"\[scanner\] lens is unknown; known are axis_offset_mm, noise_um"),
        ({"gear": GEAR, "load": {"torque_Nm": 1}}, r"\[load\] needs both \[pinion\] and \[gear\]; only \[gear\] is there"),
        ({"gear": GEAR, "pinion": GEAR, "load": {}}, r"\[load\] torque_Nm and load_per_width_N_mm are both missing: one of them"),
        ({"gear": GEAR, "pinion": GEAR, "load": {"torque": 1}}, r"\[load\] torque is unknown \(torque_Nm\?\)"),
        ({"gear": GEAR, "pinion": GEAR, "load": {"torque_Nm": -1}}, r"\[load\] torque_Nm = -1: must be above 0"),
        ({"gear": GEAR | {"helix_angle": "15"}, "pinion": GEAR}, r"^\[gear\] helix_angle = '15': "),
        ({"gear": GEAR, "pinion": GEAR | {"helix_angle": "15"}}, r"^\[pinion\] helix_angle = '15': "),
        ({"gear": GEAR, "pinion": GEAR, "load": {"torque_Nm": 0}}, r"\[load\] torque_Nm = 0: must be above 0 and at most 1e\+09"),
        (
            {"gear": GEAR, "pinion": GEAR, "load": {"load_per_width_N_mm": 0}},
            r"\[load\] load_per_width_N_mm = 0: must be above 0 and at most 100000",
        ),
        (
            {"gear": GEAR, "pinion": GEAR, "load": {"torque_Nm": 1, "poisson": 0.5}},
            r"\[load\] poisson = 0.5: must lie from 0 to 0.49",
        ),
        ({"gear": GEAR, "scanner": {"noise_um": 0}}, r"\[scanner\] noise_um = 0 µm: must lie from 0.001"),
        ({"gear": GEAR, "scanner": {"turntable": 0}}, r"\[scanner\] turntable = 0: must be true or false"),
        ({"gear": GEAR, "scanner": {"stitched": "no"}}, r"\[scanner\] stitched = 'no': must be true or false"),
        ({"gear": GEAR, "scanner": {"axis_offset_mm": "x"}}, r"\[scanner\] axis_offset_mm = 'x': must be a number"),
    ],
)
def test_wrong_tables_are_named(data, message):
    _refused(data, f"^{message}")


class TestFiles:
    @pytest.mark.parametrize(
        ("content", "message"),
        [
            (b"", "neither"),
            (b"\x89PNG\r\n\x1a\n\x00\xff", "is not text"),
            (b"teeth == 3", "is not TOML: .*line 1"),
            (b"[gear]\nteeth = 12\nteeth = 13\n", "is not TOML"),
            (b"[gear]\nteeth = 12\nmodule = 6,35\n", "line 3.*'module = 6,35': a point is needed as decimal sign"),
            (b"[gear]\nmodule = 6.35 mm\n", "line 2.*'module = 6.35 mm': a number stands alone, without a unit"),
            (b"[report]\ndate = 2026-13-22\n", "line 2.*'date = 2026-13-22': is no date; year-month-day"),
            (b"[report]\ndate = 2026-02-30\n", "line 2.*'date = 2026-02-30': is no date"),
            (b"[report]\nserial = 1\ndate = 22.11.2026\n", "line 3.*'date = 22.11.2026': is no date; .*in quotes"),
            (b"[gear]\nmodule 6.35\n", "line 2.*: 'module 6.35'$"),
            ("# Zähne\n[gear]\n".encode("cp1252"), "is not text in UTF-8"),
            (b"teeth = 12\nmodule = 2\nface_width = 5\n", r"teeth = 12 stands in no section: it needs a line \[gear\]"),
            (b"[gaer]\nteeth = 12\n", r"\[gaer\] is unknown \(gear\?\)"),
            (b"a = " + b"[" * 5000, "is not TOML"),
            (b"[gear]\nteeth = " + b"1" * 5000, "is not TOML"),
            (
                b"[gear]\nteeth = 12\nmodule = 0x" + b"1" * 5000,
                "module = a number of thousands of digits: must be a finite number",
            ),
        ],
    )
    def test_what_is_no_design_is_refused_with_the_files_name(self, tmp_path, content, message):
        path = _write(tmp_path, content)
        with pytest.raises(InputError, match=message) as refused:
            read_design(path)
        assert str(refused.value).startswith(f"{path}: ")
        assert "\n" not in str(refused.value)

    def test_missing_file_and_folder(self, tmp_path):
        with pytest.raises(InputError, match=r"none\.toml: no such file"):
            read_design(tmp_path / "none.toml")
        with pytest.raises(InputError, match="is a folder"):
            read_design(tmp_path)

    def test_windows_line_ends_and_byte_order_mark(self, tmp_path):
        text = b"\xef\xbb\xbf" + PAPER.replace("\n", "\r\n").encode()
        assert read_design(_write(tmp_path, text)).gears["gear"].teeth == 24


def test_a_file_as_windows_writes_it(tmp_path):
    plain = read_design(_write(tmp_path, PAPER)).gears
    for text in (PAPER.replace("\n", "\r\n").encode(), b"\xef\xbb\xbf" + PAPER.encode(), PAPER.encode("utf-16")):
        assert read_design(_write(tmp_path, text)).gears == plain


def test_a_thinning_says_where_it_comes_from(tmp_path):
    """What `gearwear design` writes reads back; the drawing's is the usual one, and needs no word."""
    (measured,) = parse_design({"gear": GEAR | {"thinning": 0.08, "thinning_from": "measured"}}).gears.values()
    assert measured.spec.thinning_measured and "thinning_from" in design_text(measured.spec)
    assert read_design(_write(tmp_path, design_text(measured.spec))).gears["gear"].spec == measured.spec
    for said in ({}, {"thinning_from": "drawing"}):
        (drawn,) = parse_design({"gear": GEAR | {"thinning": 0.08} | said}).gears.values()
        assert not drawn.spec.thinning_measured and "thinning_from" not in design_text(drawn.spec)
    table = _write(tmp_path, "key,value,unit\nz,20,\nm,2,mm\nb,10,mm\nthinning,0.08,mm\nthinning_from,measured,\n", "drawing.csv")
    assert read_design(table).gears["gear"].spec == measured.spec
    _refused({"gear": GEAR | {"thinning_from": "scan"}}, "thinning_from = 'scan': must be drawing or measured")
    _refused({"gear": GEAR | {"thinning_from": 1}}, "must be a word in quotes")
