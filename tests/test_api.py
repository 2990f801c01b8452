"""``import gearwear as gw``: lazy, typed, the same stages as the whole, and results that show themselves without dumping arrays."""

from __future__ import annotations

import ast
import inspect
import math
import re
import subprocess
import sys
from dataclasses import FrozenInstanceError, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import gearwear as gw
from gearwear.comparison.closing import measure
from gearwear.design.card import Card, few, measured
from gearwear.meshing.study import flanks_as_drawn
from gearwear.report.figures.colours import ColourScale
from gearwear.scan.reading import read_scan as read_files
from tests.report.fake import real_results, real_scan

if TYPE_CHECKING:
    from gearwear.identify.candidates import Candidates
    from gearwear.scan.types import Scan

ROOT = Path(__file__).resolve().parents[1]


@cache
def scanned() -> tuple[gw.Design, Path]:
    """A pair, and the scan of its coated and worn pinion."""
    return gw.read_design(gw.example()), real_scan()


@cache
def proposed() -> Candidates:
    """What the scan by itself looks like."""
    return gw.propose_design(gw.read_scan(scanned()[1]))


@cache
def fresh() -> list[str]:
    """What a process of its own has loaded once it has imported the package, and read a design; and where a function then comes from whose command was
    imported."""
    code = """import sys, gearwear as gw
print([m for m in ("numpy", "scipy", "matplotlib") if m in sys.modules])
gw.read_design(gw.example())
print([m for m in ("matplotlib", "trimesh", "manifold3d") if m in sys.modules])
import gearwear.commands.compare
print(gw.compare.__module__)"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


class TestNames:
    def test_importing_loads_not_even_numpy(self):
        assert fresh()[0] == "[]"

    def test_a_name_loads_no_more_than_it_needs(self):
        assert fresh()[1] == "[]"

    def test_every_name_is_there_and_documented(self):
        for name in gw.__all__:
            value = getattr(gw, name)
            assert value.__doc__, name
            assert isinstance(value, ModuleType) or value.__module__.startswith("gearwear."), name
            assert name in dir(gw)

    def test_type_checkers_see_the_same_names(self):
        tree = ast.parse((ROOT / "gearwear" / "__init__.py").read_text(encoding="utf-8"))
        (typed,) = [node for node in tree.body if isinstance(node, ast.If)]
        seen = {}
        for node in typed.body:
            assert isinstance(node, ast.ImportFrom)
            for alias in node.names:
                assert alias.asname == alias.name  # else mypy would not re-export it
                seen[alias.name] = node.module
        assert set(seen) == set(gw.__all__)
        for name, home in seen.items():
            own = import_module(f"{home}.{name}") if name == "figures" else getattr(import_module(home), name)
            assert getattr(gw, name) is own, name

    def test_what_functions_take_can_be_made_with_what_is_there(self):
        plain = "None|Path|Name|Sequence|ArrayLike|Floats|Literal|Cycle|Quantity|BacklashKind|Progress"
        results = "Scan|MeasuredGear|Inspection|Results|Measured|PairStudy|LoadedStudy|WearStudy|WearFit"
        inner = "CellGrid|Bands"  # how a scan is cut up, and which surface a point may belong to
        for function in filter(inspect.isfunction, (getattr(gw, name) for name in gw.__all__)):
            for parameter in inspect.signature(function).parameters.values():
                taken = re.findall(rf"\b(?!(?:{plain}|{results}|{inner})\b)[A-Z]\w+", parameter.annotation)
                assert set(taken) <= set(gw.__all__), f"{function.__name__}: {parameter}"

    def test_the_page_lists_every_function(self):
        page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
        for name in gw.__all__:
            if inspect.isfunction(getattr(gw, name)) and name != "example":
                assert f"`gw.{name}" in page, name

    def test_what_is_not_there_is_an_attribute_error(self):
        with pytest.raises(AttributeError, match="no attribute 'nothing'"):
            gw.nothing  # noqa: B018

    def test_importing_a_command_does_not_hide_the_function_of_its_name(self):
        for name in ("compare", "inspect"):
            before = getattr(gw, name)
            assert callable(import_module(f"gearwear.commands.{name}").main)
            assert getattr(gw, name) is before
        assert fresh()[2] == "gearwear.api"


class TestStages:
    @pytest.mark.long
    def test_step_by_step_is_the_whole(self):
        design, file = scanned()
        stepwise = gw.find_effects(gw.register(design, gw.read_scan(file)))
        whole = real_results()
        wear = gw.find_wear(stepwise)
        assert (wear.volume, wear.volume_std) == (whole.wear.volume, whole.wear.volume_std)
        np.testing.assert_array_equal(stepwise.pose.rotation, whole.measured.pose.rotation)
        assert whole.inspection is not None
        np.testing.assert_array_equal(gw.inspect(stepwise).coverage, whole.inspection.coverage)
        assert [effect.name for effect in stepwise.loop.effects] == ["coating"]

    def test_settings_leave_to_the_measured_gear_what_they_do_not_say(self):
        """U of the pitch knows scale, pose and datum, whatever else is chosen: the same as without settings."""
        design = scanned()[0]
        datum = replace(design.datum, axis="ends", temperature=23.0, temperature_std=5.0)
        gear = replace(real_results().measured, design=replace(design, datum=datum))
        plain, chosen = gw.inspect(gear), gw.inspect(gear, gw.Settings(required_class=9))
        assert (plain.settings.axis, chosen.settings.axis, chosen.settings.required_class) == ("ends", "ends", 9)
        assert chosen.settings.scale_std == gear.design.scale_std > 0.0
        for name in ("single", "index", "cumulative"):
            one, other = getattr(plain.pitch, name), getattr(chosen.pitch, name)
            np.testing.assert_array_equal(one.value, other.value)
            np.testing.assert_array_equal(one.expanded, other.expanded)
        np.testing.assert_array_equal(plain.profile.slope.expanded, chosen.profile.slope.expanded)

    def test_settings_that_are_stated_are_kept(self):
        design = scanned()[0]
        gear = replace(real_results().measured, design=replace(design, datum=replace(design.datum, axis="ends")))
        about_teeth = gw.inspect(gear, gw.Settings(axis="teeth", noise=0.05, scale_std=0.0, pose_covariance=np.zeros((6, 6))))
        assert about_teeth.settings.axis == "teeth"
        assert about_teeth.settings.noise == 0.05  # of a spur gear along the normal as across it
        assert about_teeth.pitch.index.shared is not None and not about_teeth.pitch.index.shared.any()
        np.testing.assert_array_equal(about_teeth.pitch.index.value, real_results().inspection.pitch.index.value)
        with pytest.raises(gw.InputError, match="an axis from the bore needs bore_diameter"):
            gw.inspect(gear, gw.Settings(axis="bore"))

    @pytest.mark.parametrize(("stage", "words"), [
        (lambda: gw.register("design.toml", gw.read_scan(scanned()[1])), "design of type str: what gw.read_design"),
        (lambda: gw.study_meshing("pair.toml", loss=0.1), "design of type str: what gw.read_design"),
        (lambda: gw.register(scanned()[0], "scan.ply"), "scan of type str: what gw.read_scan"),
        (lambda: gw.propose_design("scan.ply"), "scan of type str: what gw.read_scan"),
        (lambda: gw.write(3, "out"), "result = int: one of compare or study_meshing"),
        (lambda: gw.read_design({"gear": {"teeth": 12}}), "design of type dict: the path of a file would be right"),
        (lambda: gw.compare({"gear": {"teeth": 12}}, scanned()[1]), "design of type dict: the path of a file"),
        (lambda: gw.read_scan(["a.ply", "b.ply"]), "scan of type list: a file, or what gw.read_scan or gw.as_scan returns, would be right"),
        (lambda: gw.compare(scanned()[0], np.ones((200, 4))), r"points of shape \(200, 4\): \(n, 3\)"),
        (lambda: gw.compare(scanned()[0], [3]), "scan of type int: a file"),
        (lambda: gw.compare(scanned()[0], None), "scan of type NoneType: a file"),
        (lambda: gw.find_effects(scanned()[0]), "measured of type Design: what gw.register returns would be right"),
        (lambda: gw.find_effects(real_results().measured, worn="left"), r"^worn 'left': a set of sides such as {gw.Side.LEFT} would be right"),
        (lambda: gw.find_effects(real_results().measured, worn=[0]), "^side 0: gw.Side.LEFT or gw.Side.RIGHT"),
        (lambda: gw.Side("up"), "^side 'up': gw.Side.LEFT or gw.Side.RIGHT"),
        (lambda: gw.find_wear(scanned_scan()[1]), "measured of type Scan: what gw.register or gw.find_effects returns"),
        (lambda: gw.inspect(np.ones((200, 3))), "measured of type ndarray: what gw.register or gw.find_effects returns"),
        (lambda: gw.as_columns(scanned()[0]), "inspection of type Design: what gw.inspect returns"),
        (lambda: gw.report_arrays(scanned()[0]), "results of type Design: what gw.compare returns"),
        (lambda: gw.exact_meshing("pinion", "gear", 114.3), "pinion of type str: one of design.gears would be right"),
        (lambda: gw.mesh_contact(*scanned()[0].gears.values(), 114.3), "driver of type Gear: what gw.nominal_profiles returns"),
        (lambda: gw.locate(np.ones((5, 3)), scanned()[0]), "gear of type Design: one of design.gears would be right"),
        (lambda: gw.locate(np.ones((5, 6)), scanned()[0].gears["pinion"]), r"points of shape \(5, 6\): \(n, 3\), mm in the design's frame"),
        (lambda: gw.locate(np.ones(3), scanned()[0].gears["pinion"]), r"points of shape \(3,\)"),
        (lambda: gw.read_scan(scanned()[1], units=["mm"]), r"units \['mm'\]: one of mm"),
        (lambda: gw.example(3), "^3: the bundled example has design.toml"),
        (lambda: gw.inspect(real_results().measured, {"required_class": 7}), "settings of type dict: a gw.Settings"),
        (lambda: gw.register(*scanned_scan(), part=["pinion"]), "part = .*: the design has only pinion, gear"),
        (lambda: gw.register(*scanned_scan(), grid=3), "grid of type int: a CellGrid"),
        (lambda: gw.register(scanned()[0], None), "scan of type NoneType: "),
        (lambda: gw.compare(*scanned(), progress=None), "progress of type NoneType: a function"),
        (lambda: gw.compare(*scanned(), ahead=2e6), "ahead of type float: a gw.Ahead"),
        (lambda: gw.compare(*scanned(), loop="no"), "loop of type str: True or False"),
        (lambda: gw.write(real_results(), None), "folder of type NoneType: the name of a folder"),
        (lambda: gw.write(real_results(), "out", also=None), "also = None: a list of names"),
        (lambda: gw.write(real_results(), "out", sections=7.5), "sections = 7.5: a list of heights in mm"),
        (lambda: gw.write(gw.study_meshing(bundled(), loss=0.1), "out", law=3), "law of type int: "),
        (lambda: gw.as_columns(real_results().inspection, ["teeth"]), "rows = .*: one of findings, flanks, teeth"),
        (lambda: gw.propose_design(scanned_scan()[1], module="6.35"), "module = '6.35': a number, in mm"),
        (lambda: gw.locate("points.csv", scanned()[0].gears["pinion"]), "points of type <U10: an array of real numbers"),
        (lambda: gw.locate(np.ones((5, 3)), scanned()[0].gears["pinion"], bands=0.3), "bands of type float"),
        (lambda: gw.shaft_movement(scanned()[0], 3, 114.3, 0.1), "pinion of type Design: one of design.gears"),
        (lambda: gw.study_load("pair.toml"), "design of type str: what gw.read_design"),
        (lambda: gw.study_load(scanned()[0], load=100.0), "load of type float: a gw.LoadSpec"),
        (lambda: gw.study_load(scanned()[0], flanks=("a", "b")), "one of flanks of type str: what gw.nominal_profiles"),
        (lambda: gw.mesh_contact(*drawn_profiles(), 114.3, variants=drawn_profiles()), "variants = .*: a list of pairs"),
        (lambda: gw.mesh_contact(*drawn_profiles(), 114.3, variants=[(3, 4)]), "one of variants of type int: "),
        (lambda: gw.fit_wear_law("pinion", 3, 114.3, [1.0], [0.1]), "gear of type str: one of design.gears"),
        (lambda: gw.fit_wear_law(*bundled().gears.values(), 114.3, "roll", [0.1]), "roll of type <U4: an array of real numbers"),
        (lambda: gw.forecast_wear("fits", 1e6, [2e6]), "one of fits of type str: what gw.fit_wear_law returns"),
        (lambda: gw.cycles_left(None, 1e6, 0.1, "depth"), "fits = None: a list of what gw.fit_wear_law returns"),
        (lambda: gw.nominal_profiles(scanned()[0]), "gear of type Design: one of design.gears"),
        (lambda: gw.nominal_profiles(bundled().gears["gear"], z=[None, 2.0]), r"z = \[None, 2.0\]: one or more finite"),
        (lambda: gw.nominal_profiles(bundled().gears["gear"], z=[3.0, 2.0]), r"z = \[3.0, 2.0\]: one or more finite numbers that rise"),
        (lambda: gw.nominal_profiles(bundled().gears["gear"], radius=[np.nan]), r"radius = \[nan\]: one or more finite"),
    ])  # fmt: skip
    def test_what_a_stage_does_not_take_is_told(self, stage, words):
        """Each ended in an AttributeError or TypeError of a module that the user does not know."""
        with pytest.raises(gw.InputError, match=words):
            stage()

    def test_a_half_that_is_none_is_refused(self):
        with pytest.raises(gw.InputError, match="half = 'foo': lower or upper would be right"):
            gw.inspect(real_results().measured, half="foo")
        with pytest.raises(gw.InputError, match="has one helix and no halves"):
            gw.inspect(real_results().measured, half="upper")

    def test_an_array_is_as_good_as_a_file(self):
        design, file = scanned()
        points = np.loadtxt(file)
        from_file, from_array = gw.read_scan(file)[0], gw.as_scan(points, name="mine")
        np.testing.assert_array_equal(from_file.points, from_array.points)
        assert from_array.kind == "cloud"
        pose = gw.register(design, from_array).pose
        np.testing.assert_array_equal(pose.translation, gw.register(design, [from_file]).pose.translation)
        for wrong in (np.zeros(3), np.zeros((5, 4)), np.zeros((2, 3))):
            with pytest.raises(gw.InputError):
                gw.as_scan(wrong)

    def test_a_comparison_takes_scans_as_well_as_files(self):
        """The same pose from points in memory; and the same points are one view, and no scan before wear, wherever they are from."""
        design, file = scanned()
        scan = gw.as_scan(np.loadtxt(file), name="mine")
        from_file, from_scan = (measure(design, [one], loop=False) for one in (file, scan))
        np.testing.assert_array_equal(from_scan.pose.translation, from_file.pose.translation)
        assert from_scan.scans[0].files == ("mine",)
        drawn = {"design": design, "loop": False, "inspection": False}
        by_array, by_scan = gw.compare(scans=scan.points, **drawn), gw.compare(scans=scan, **drawn)
        np.testing.assert_array_equal(
            by_array.measured.placed.registration.pose.translation, by_scan.measured.placed.registration.pose.translation
        )
        halves = read_files([gw.as_scan(half) for half in np.array_split(scan.points, 2)])
        assert [set(half.view) for half in halves] == [{0}, {1}]
        for before in ((), gw.as_scan(scan.points)):
            with pytest.raises(gw.InputError, match=r"array: is (given twice|the same as mine): "):
                gw.compare(design, scan if before else [scan, gw.as_scan(scan.points)], before=before, loop=False)

    @pytest.mark.parametrize(
        ("points", "normals", "words"),
        [
            (np.ones((100, 3)), np.ones((50, 3)), r"normals of shape \(50, 3\): \(100, 3\), one for each point, would be right"),
            (np.ones((100, 3)), np.ones((100, 2)), r"normals of shape \(100, 2\): \(100, 3\)"),
            (np.ones((100, 2)), np.ones((100, 2)), r"normals of shape \(100, 2\): \(100, 3\)"),
            (np.ones((3, 3)), np.ones(9), r"normals of shape \(9,\): \(3, 3\)"),
            (np.ones((100, 3)), "up", r"normals of type <U2: an array of real numbers would be right"),
            ("scan.ply", None, r"points of type <U8: an array of real numbers would be right"),
            (np.full((4, 3), "1.5"), None, r"points of type <U3"),
            ([[1.0, 2.0, 3.0], [1.0, 2.0]], None, r"points: rows of different lengths"),
            (np.ones((100, 3), dtype=complex), None, r"points of type complex128"),
            (
                np.full((4, 3), None),
                np.array([["x"] * 3] * 4, dtype=object),
                r"normals: rows of different lengths, or no numbers",
            ),
        ],
    )
    def test_what_is_no_array_of_points_is_refused(self, points, normals, words):
        with pytest.raises(gw.InputError, match=words):
            gw.as_scan(points, normals)

    def test_a_design_from_the_scan_gives_the_same_gear(self):
        design, found = scanned()[0], proposed()
        assert found.ranked[0].gear.base_radius == design.gears["pinion"].base_radius
        assert found.ranked[0].gear.tip_radius == pytest.approx(design.gears["pinion"].tip_radius)

    def test_a_design_from_views_in_one_frame_is_that_of_their_points_together(self):
        halves = np.array_split(scanned_scan()[1].points, 2)  # each sees all of the gear: the points come in no order
        views = [gw.as_scan(points, name=f"view {number}") for number, points in enumerate(halves, 1)]
        assert gw.propose_design(views).ranked[0].gear == proposed().ranked[0].gear

    @pytest.mark.long
    @pytest.mark.parametrize("turn", [[0.0, 0.0, 0.2], [0.15, 0.0, 0.0]])
    def test_views_in_frames_of_their_own_are_refused_by_name(self, turn):
        points = scanned_scan()[1].points
        moved = Rotation.from_rotvec(turn).apply(points[1::4])  # about the gear, as it lies near the origin
        with pytest.raises(gw.InputError, match="one frame"):
            gw.propose_design([gw.as_scan(points[::2], name="first view"), gw.as_scan(moved, name="moved view")])
        with pytest.raises(gw.InputError, match="no scan is given"):
            gw.propose_design([])

    @pytest.mark.parametrize("known", [{"module": 0.0}, {"module": float("nan")}, {"pressure_angle": 0.0}, {"face_width": 0.0}])
    def test_what_is_known_must_be_possible(self, known):
        with pytest.raises(gw.InputError, match="would be right"):
            gw.propose_design(scanned_scan()[1], **known)

    def test_paths_may_be_strings(self, tmp_path):
        with pytest.raises(gw.InputError, match=r"nowhere.toml: no such file"):
            gw.compare("nowhere.toml", "nowhere.ply")
        with pytest.raises(gw.InputError, match=r"nowhere.ply"):
            gw.compare(str(gw.example()), "nowhere.ply")
        with pytest.raises(gw.InputError, match=r"also = 'vrml'"):
            gw.write(real_results(), tmp_path, also=["vrml"])

    @pytest.mark.parametrize(
        ("sections", "words"),
        [
            ([float("nan"), -5.0], "sections nan, -5.0: heights from 0 to 15 mm would be right"),
            ([7.0, 15.1], "sections 7.0, 15.1: heights from 0 to 15 mm"),
            ("all", "sections a, l, l: heights from 0 to 15 mm"),
        ],
    )
    def test_sections_off_the_face_are_refused_and_nothing_is_written(self, tmp_path, sections, words):
        with pytest.raises(gw.InputError, match=words):
            gw.write(real_results(), tmp_path / "out", sections=sections)
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.long
    @pytest.mark.usefixtures("blank_figures")
    def test_write_writes_what_the_dict_says(self, tmp_path):
        report = gw.write(real_results(), tmp_path / "out", also=["topography"], sections=[7.5])
        assert set(report["files"]) == {path.name for path in (tmp_path / "out").iterdir()}
        assert {"topography.csv", "sections.dxf"} <= set(report["files"])
        plain = gw.as_dict(real_results())
        assert plain["wear"] == report["wear"]

    @pytest.mark.parametrize(("wrong", "words"), [
        (lambda axis: gw.figures.waterfall(axis, None), "loop of type NoneType: that of a gear whose effects"),
        (lambda axis: gw.figures.waterfall(axis.figure, real_results().loop), "axis of type Figure: an axis of matplotlib"),
        (lambda axis: gw.figures.contact_map(axis, "share"), r"share of type str: an array \(teeth, 2, n_z, n_L\)"),
        (lambda axis: gw.figures.contact_map(axis, np.ones((12, 3, 4, 5))), r"share of shape \(12, 3, 4, 5\): an array \(teeth, 2"),
        (lambda axis: gw.figures.flank_map(axis, np.ones((12, 2, 4, 5)), 100.0), "scale of type float: a .*ColourScale"),
        (lambda axis: gw.figures.tooth_section(axis, np.ones((5, 2)), np.ones((6, 2)), 38.0), r"worn_xy of shape .* n = 5, as nominal_xy has"),
        (lambda axis: gw.figures.tooth_section(axis, np.ones((5, 2)), np.ones((5, 2)), "38"), "reference_radius_mm = '38': a number"),
        (lambda axis: gw.figures.thickness_per_tooth(axis, real_results()), "thickness of type Results: results.wear.thickness"),
        (lambda axis: gw.figures.transmission_error(axis, real_results().pair), "curves of type PairResult: gw.report_arrays"),
        (lambda axis: gw.figures.traces(axis, np.ones(4), np.ones((12, 5)), 20.0, "k"), "deviation_um of shape .* n = 4"),
        (lambda axis: gw.figures.traces(axis, np.ones(5), np.ones((12, 5)), 0.0, "k"), "um_per_tooth = 0.0: a number above 0"),
        (lambda axis: gw.figures.traces(axis, np.ones(5), np.ones((12, 5)), 20.0, "none such"), "colour = 'none such': one of matplotlib"),
        (lambda axis: gw.figures.traces(axis, np.ones(5), np.ones((12, 5)), 20.0, None), "colour = None: one of matplotlib"),
        (lambda axis: gw.figures.colour_bar(axis, ColourScale(40.0), high=math.nan), "high = nan: a number from 0, of depths, to 1"),
        (lambda axis: gw.figures.colour_bar(axis, ColourScale(40.0), high=-1.0), "high = -1.0: a number from 0"),
        (lambda axis: gw.figures.colour_bar(axis, ColourScale(math.inf)), "limit_um = inf: a number above 0, in µm,"),
        (lambda axis: gw.figures.colour_bar(axis, ColourScale(40.0, 41.0)), "linear_um = 41.0: a number above 0 and at most limit_um"),
        (lambda axis: gw.figures.tooth_section(axis, np.ones((5, 2)), np.ones((5, 2)), math.nan), "reference_radius_mm = nan: a number"),
        (lambda axis: gw.figures.pair_in_mesh(axis, *bundled().gears.values(), 114.3), "exact of type float: what gw.exact_meshing"),
        (lambda axis: gw.figures.specific_sliding(axis, 3, None), "slid of type int: study.sliding"),
        (lambda axis: gw.figures.worn_profile(axis, real_results()), "law of type Results: results.pair.law"),
        (lambda axis: gw.figures.across_face(axis, 3), "across of type int"),
        (lambda axis: gw.figures.load_map(axis, None), "study of type NoneType: what gw.study_load returns"),
        (lambda axis: gw.figures.wear_maps(axis, real_results().loop), "loop of type Loop: what results.pair.second_loop holds"),
    ])  # fmt: skip
    def test_what_a_figure_does_not_take_is_told(self, wrong, words):
        from matplotlib.figure import Figure

        with pytest.raises(gw.InputError, match=f"{words}.* would be right"):
            wrong(Figure().add_subplot())

    def test_figures_take_an_axis_and_give_it_back(self):
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt

        arrays = gw.report_arrays(real_results())
        figure, axes = plt.subplots(1, 3)
        assert gw.figures.waterfall(axes[0], real_results().loop) is axes[0]
        assert gw.figures.thickness_per_tooth(axes[1], real_results().wear.thickness) is axes[1]
        assert gw.figures.transmission_error(axes[2], arrays.meshing) is axes[2]
        plt.close(figure)


def drawn_profiles() -> tuple[gw.ToothProfiles, ...]:
    """The example's pair as drawn."""
    return tuple(map(gw.nominal_profiles, bundled().gears.values()))


@cache
def cards() -> dict[str, Card]:
    whole = real_results()
    assert whole.loop is not None
    assert whole.pair is not None
    assert whole.inspection is not None
    measured_gear = gw.register(*scanned_scan())
    candidates = proposed()
    shown = (
        whole, whole.measured.placed.registration, whole.loop, whole.loop.effects[0], whole.wear, whole.wear.found, whole.wear.regions[0],
        whole.wear.thickness, whole.pair.contact, whole.inspection, whole.measured.scans[0], measured_gear, candidates, candidates.survey, candidates.ranked[0],
    )  # fmt: skip
    drawn = gw.read_design(gw.example())
    shown = (*shown, drawn, drawn.gears["pinion"], gw.nominal_profiles(drawn.gears["pinion"]))
    return {type(one).__name__: one for one in shown}


@cache
def scanned_scan() -> tuple[gw.Design, Scan]:
    design, file = scanned()
    return design, gw.read_scan(file)[0]


class TestCards:
    def test_shown_in_few_lines_and_never_as_arrays(self):
        for name, card in cards().items():
            text = repr(card)
            assert text.startswith(f"{name}: ")
            assert len(text.splitlines()) < 30, name
            assert max(map(len, text.splitlines())) < 260, name
            assert not any(word in text for word in ("array(", "nan", "None", "object at")), name
            if name != "Scan":
                assert any(unit in text for unit in ("µm", "mm", "°")), name

    def test_the_html_is_well_formed_and_says_the_same(self):
        from xml.etree import ElementTree

        for name, card in cards().items():
            html = card._repr_html_()
            words = "".join(ElementTree.fromstring(html).itertext())
            assert words.startswith(name)
            assert card.headline() in words
            assert all(label in words and text in words for label, text in card.rows()), name

    def test_a_design_in_a_notebook_is_its_numbers_and_not_five_thousand_letters(self):
        design = gw.read_design(gw.example())
        assert repr(design).startswith("Design: pinion and gear, a = 114.3 mm, from ")
        assert dict(design.rows())["gear"] == "24 teeth, module 6.35 mm, 15 mm wide"
        assert "tip 88.900, reference 76.200" in repr(design.gears["pinion"])  # (z + 2) m and z m
        assert gw.nominal_profiles(design.gears["pinion"]).headline().startswith("24 of 24 flanks known")

    def test_no_wear_is_said_and_not_0_mm3_of_0_regions(self):
        results = real_results()
        found = replace(results.wear.found, regions=(), volume=0.0, volume_std=0.0)
        none = replace(results, wear=replace(results.wear, found=found))
        assert none.headline() == "pinion of 12 teeth, no wear found"
        assert found.headline().startswith("none found, seen from ")

    def test_markup_in_a_files_name_is_escaped(self):
        scan = replace(scanned_scan()[1], files=("<b>&.ply",))
        assert "&lt;b&gt;&amp;.ply" in scan._repr_html_()

    def test_uncertainties_stand_with_the_numbers(self):
        shown = cards()
        for name in ("Wear", "WearRegion", "Registration", "Loop", "FoundEffect", "SectionThickness", "CandidateGear"):
            assert "±" in repr(shown[name]), name
        assert "U " in repr(shown["Inspection"])
        coat = shown["FoundEffect"].rows()[0]
        assert coat[0] == "thickness"
        value, std = (float(part) for part in coat[1].removesuffix(" µm").split(" ± "))
        assert abs(value - 20.0) < 3.0 * std + 0.1

    def test_they_stay_frozen(self):
        with pytest.raises(FrozenInstanceError):
            real_results().wear.found = None  # type: ignore[misc]
        assert not hasattr(real_results().wear, "__dict__")

    def test_a_long_list_is_cut(self):
        rows = few([(str(i), "") for i in range(25)])
        assert len(rows) == 11
        assert rows[-1] == ("…", "15 more")

    @pytest.mark.parametrize(
        ("value", "std", "text"),
        [
            (1.23456, 0.0123, "1.235 ± 0.012 mm"),
            (123.4, 56.0, "123 ± 56 mm"),
            (5.0, 0.0, "5.00 mm"),
            (0.0, 1e-9, "0.0000000000 ± 0.0000000010 mm"),
        ],
    )
    def test_two_digits_of_the_standard_deviation(self, value, std, text):
        assert measured(value, std, "mm") == text


def test_what_is_listed_is_what_is_public():
    assert {name for name in dir(gw) if not name.startswith("_")} == set(gw.__all__)


def test_an_example_that_is_not_there_is_refused_with_those_that_are():
    with pytest.raises(gw.InputError, match=r"nothere: the bundled example has design.toml, scan.ply.gz, truth.json"):
        gw.example("nothere")


def bundled() -> gw.Design:
    return gw.read_design(gw.example())


def turned(**how: object) -> object:
    flanks = flanks_as_drawn(*bundled().gears.values())
    return gw.mesh_contact(*flanks, 114.3, **how)


def loaded(**how: object) -> object:
    return gw.study_load(bundled(), load=gw.LoadSpec(load_per_width=100.0), **how)


CYCLES = "one of pitch, revolution, driven, hunting would be right"
ROUND = np.column_stack([np.cos(np.arange(500.0)), np.sin(np.arange(500.0)), np.arange(500.0)])


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda: turned(cycle="revolutions"), f"cycle = 'revolutions': {CYCLES}"),
        (lambda: turned(cycle=["pitch"]), rf"cycle = \['pitch'\]: {CYCLES}"),
        (lambda: turned(positions_per_pitch=3.5), "positions_per_pitch = 3.5: a whole number from 1 up would be right"),
        (lambda: turned(positions_per_pitch=0), "positions_per_pitch = 0: a whole number from 1 up would be right"),
        (lambda: turned(start_tooth=1.5), "start_tooth = 1.5: a whole number would be right"),
        (lambda: turned(tolerances=()), r"tolerances \(\): a sequence of one or more would be right"),
        (lambda: turned(drive_side="up"), "side 'up': gw.Side.LEFT"),
        (lambda: loaded(cycle="x"), f"cycle = 'x': {CYCLES}"),
        (lambda: loaded(start_tooth=True), "start_tooth = True: a whole number would be right"),
        (lambda: loaded(drive_side=0), "side 0: gw.Side.LEFT"),
        (lambda: gw.shaft_movement(*bundled().gears.values(), 114.3, 0.1, kind="foo"), "kind = 'foo': one of reference, operating, normal"),
        (lambda: gw.register(bundled(), []), "no scan is given; what gw.read_scan returns would be right"),
        (lambda: gw.register(bundled(), [gw.as_scan(ROUND), gw.as_scan(ROUND[:, :2])]), "views of one kind would be right"),
        (lambda: gw.read_design("a\0b"), "cannot be read: embedded null byte; a design in TOML is needed"),
        (lambda: gw.read_design("a\0b.csv"), "cannot be read: embedded null byte"),
    ],
)  # fmt: skip
def test_what_a_verb_cannot_take_is_refused_with_what_would_be_right(ask, words):
    with pytest.raises(gw.InputError, match=words):
        ask()


def test_whole_numbers_of_numpy_are_whole_numbers():
    plain, counted = turned(cycle="pitch", start_tooth=2), turned(cycle="pitch", start_tooth=np.int64(2))
    np.testing.assert_array_equal(plain.driven_tooth, counted.driven_tooth)
    assert set(plain.driven_tooth) <= {1, 2, 3}
