"""What a user can get wrong at the front doors: status 2, one line with what is wrong, and an output folder as it was."""

from __future__ import annotations

import gzip
import itertools
import os
import random
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.commands.doors import EXAMPLE, ONE, PAIR, Said, run
from tests.scan.writers import ply, stl, torus, xyz
from tests.synthetic import PINION, WHEEL, Recipe, make_scan

RNG = np.random.default_rng(5)


def gear_points(**changed: float) -> np.ndarray:
    return make_scan(Recipe(gear=replace(PINION, **changed)).of_size(12_000), 1).points


def on_sphere(n: int) -> np.ndarray:
    v = RNG.normal(size=(n, 3))
    return 44.0 * v / np.linalg.norm(v, axis=1)[:, None]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a good scan, bad scans and bad designs."""
    folder = tmp_path_factory.mktemp("bad")
    good = gear_points()
    box = RNG.normal(size=(8000, 3))
    files: dict[str, bytes] = {
        "good.ply": ply(good, kind="f8"),
        "empty.ply": b"",
        "cut.ply": ply(good)[:60_000],
        "cut.xyz.gz": gzip.compress(xyz(good))[:40_000],
        "cut.stl": stl(*torus())[:3000],
        "junk.ply": RNG.integers(0, 256, 4000, dtype=np.uint8).tobytes(),
        "words.txt": b"this is\nno scan at all\n",
        "nan.xyz": xyz(np.full((2000, 3), np.nan)),
        "one.xyz": xyz(good[:1]),
        "ten.xyz": xyz(good[:10]),
        "hundred.xyz": xyz(good[:: len(good) // 120]),
        "same.xyz": xyz(np.ones((3000, 3))),
        "line.xyz": xyz(np.linspace(0.0, 80.0, 3000)[:, None] * [1.0, 0.0, 0.0]),
        "plane.xyz": xyz(np.column_stack([RNG.uniform(-44, 44, (4000, 2)), np.zeros(4000)])),
        "inch.ply": ply(good / 25.4),
        "metre.ply": ply(good / 1000.0),
        "micrometre.ply": ply(good * 1000.0),
        "wheel.ply": ply(make_scan(Recipe(gear=WHEEL).of_size(12_000), 1).points),
        "thirteen.ply": ply(gear_points(teeth=13)),
        "module6.ply": ply(gear_points(module=6.0)),
        "sphere.ply": ply(on_sphere(8000)),
        "box.ply": ply(box / np.abs(box).max(axis=1)[:, None] * [44.0, 44.0, 7.5]),
        "cloud.ply": ply(RNG.uniform(-44.0, 44.0, (8000, 3))),
        "torus.stl": stl(*torus()),
        "scan.foo": b"1 2 3\n",
        "circle.xyz": "\n".join(f"{44 * np.cos(t)} {44 * np.sin(t)}" for t in np.linspace(0.0, 6.28, 2000)).encode(),
        "one.toml": ONE.encode(),
        "nothing.toml": b"",
        "broken.toml": b"[gear\n",
        "binary.toml": bytes(range(256)),
        "both.toml": ONE.encode() + b"diametral_pitch = 4\n",
        "pointed.toml": ONE.encode() + b"addendum = 2.5\n",
        "steep.toml": ONE.encode() + b"helix_angle = 75\n",
        "internal.toml": ONE.encode() + b"internal = true\n",
        "nan.toml": ONE.replace("6.35", "nan").encode(),
        "misspelt.toml": ONE.replace("teeth", "tooth").encode(),
        "mates.toml": b"[pinion]\nteeth = 20\nmodule = 2\nface_width = 5\n[gear]\nteeth = 30\nmodule = 3\n",
        "wide.toml": b"[pinion]\nteeth = 12\nmodule = 6.35\nface_width = 15\n[gear]\nteeth = 24\nface_width = 18\n",
        "jam.toml": PAIR.read_bytes().replace(b"114.3 ", b"113.9 "),
        "file": b"",
    }
    for name, data in files.items():
        (folder / name).write_bytes(data)
    return folder


def refused(said: Said, *words: str) -> None:
    """One line that says all of this, and nothing else."""
    assert said.status == 2, said
    assert said.out == ""
    assert said.err.startswith("gearwear: ") and said.err.count("\n") == 1, said.err
    for word in words:
        assert word in said.err


SCANS = [
    ("missing.ply", "no such file"),
    ("empty.ply", "is empty"),
    ("cut.ply", "cut off"),
    ("cut.xyz.gz", "no complete gzip file"),
    ("cut.stl", "the file has room for"),
    ("junk.ply", "PLY header"),
    ("words.txt", "no line of numbers"),
    ("nan.xyz", "finite"),
    ("one.xyz", "holds 1 point: at least"),
    ("ten.xyz", "holds 10 points"),
    ("hundred.xyz", "from a denser scan"),
    ("same.xyz", "1 of its 3,000 points"),
    ("line.xyz", "not of this gear"),
    ("plane.xyz", "does not fit the design"),
    ("inch.ply", "units = in"),
    ("metre.ply", "units = m "),
    ("micrometre.ply", "units = um"),
    ("wheel.ply", "does not fit the design: "),
    ("thirteen.ply", "13 teeth are counted in it, and the design has 12"),
    ("module6.ply", "12 teeth and tip diameter 88.90 mm"),
    ("sphere.ply", "does not fit the design: "),
    ("box.ply", "not of this gear"),
    ("cloud.ply", "does not fit the design: "),
    ("torus.stl", "points lie on flanks of the design"),
    ("circle.xyz", "not of this gear"),
    ("scan.foo", ".ply .xyz .asc"),
    (".", "is a folder"),
    ("x" * 3000 + ".ply", "cannot be opened"),
    ("broken\nname.ply", "broken\\nname.ply: no such file"),
]


SHOWN_BY_OTHERS = ("box.ply", "cloud.ply", "wheel.ply", "module6.ply", "sphere.ply")
"""What the line, a gear of one tooth more and a sphere beside a pair are refused for as well."""


@pytest.mark.parametrize(
    ("name", "words"),
    [pytest.param(*one, marks=[pytest.mark.long] * (one[0] in SHOWN_BY_OTHERS)) for one in SCANS],
    ids=[name[:12].replace("\n", " ") for name, _ in SCANS],
)
def test_a_scan_that_is_no_good(place, tmp_path, name, words):
    said = run("compare", place / "one.toml", place / name, "--out", tmp_path / "out")
    shown = f"gearwear: {place / name}".replace("\n", "\\n")
    refused(said, words, shown.removesuffix("/."))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.long
@pytest.mark.parametrize("command", ["inspect", "compare --before"])
@pytest.mark.parametrize(("name", "words"), [SCANS[i] for i in (0, 2, 14, 18)], ids=["missing", "cut", "inch", "another"])
def test_the_same_at_the_other_doors(place, tmp_path, command, name, words):
    if command == "inspect":
        said = run("inspect", PAIR, place / name, "--out", tmp_path / "out")
    else:
        said = run(
            "compare", place / "one.toml", place / "good.ply", "--before", place / name, "--no-loop", "--out", tmp_path / "out"
        )
    refused(said, str(place / name), *([words] if name != "thirteen.ply" else []))
    assert list(tmp_path.iterdir()) == []


def test_a_scan_given_twice_is_refused(place, tmp_path):
    """As two views its points would count double; as the scan before wear too nothing would have changed."""
    good, again, out = place / "good.ply", tmp_path / "again.ply", tmp_path / "out"
    shutil.copy(good, again)
    one, rest = place / "one.toml", ("--no-loop", "--out", out)
    refused(run("compare", one, good, good, *rest), str(good), "given twice", "each view once")
    refused(run("compare", one, good, again, *rest), str(again), f"the same as {good}")
    refused(run("compare", one, good, "--before", again, *rest), str(again), "before it ran")
    assert not out.exists()


def test_a_face_width_in_inches_shows_beside_that_of_the_scan(place, tmp_path):
    text = (place / "one.toml").read_text()
    narrow = tmp_path / "narrow.toml"
    narrow.write_text("\n".join("face_width = 0.5906" if "face_width" in line else line for line in text.splitlines()))
    refused(
        run("compare", narrow, place / "good.ply", "--out", tmp_path / "out"), "by itself the scan looks like", "15.0 mm wide"
    )


def test_neither_gear_of_a_pair(place, tmp_path):
    refused(run("compare", PAIR, place / "sphere.ply", "--out", tmp_path / "out"), "nor does it fit the gear")


DESIGNS = [
    ("missing.toml", "no such file"),
    (".", "is a folder"),
    ("nothing.toml", "neither [pinion] nor [gear]"),
    ("broken.toml", "is not TOML"),
    ("binary.toml", "is not text"),
    ("good.ply", "is not "),
    ("both.toml", "module and diametral_pitch are both given"),
    ("pointed.toml", "the tooth is pointed"),
    ("steep.toml", "helix_angle = 75 degrees"),
    ("internal.toml", "no rack cuts a ring"),
    ("nan.toml", "must be a finite number"),
    ("misspelt.toml", "tooth is unknown"),
    ("mates.toml", "base pitches"),
    ("jam.toml", "the teeth jam"),
    ("x" * 3000 + ".toml", "cannot be read"),
]


@pytest.mark.parametrize(("name", "words"), DESIGNS, ids=[name[:12] for name, _ in DESIGNS])
def test_a_design_that_contradicts_itself(place, tmp_path, name, words):
    for command, inputs in (("compare", ["good.ply"]), ("inspect", ["good.ply"]), ("meshing", []), ("models", [])):
        said = run(command, place / name, *(place / scan for scan in inputs), "--out", tmp_path / "out")
        refused(said, words, str(place / name).removesuffix("/."))
        assert list(tmp_path.iterdir()) == []


ARGUMENTS = [
    ("compare one.toml good.ply --part pinion", "the design has only gear"),
    ("inspect one.toml good.ply --part pinion", "the design has only gear"),
    ("compare one.toml", "no scan is given"),
    ("compare good.ply one.toml", "the design comes first"),
    ("compare one.toml one.toml good.ply", "the design comes first and once"),
    ("compare one.toml good.ply --sections 1,x", "--sections 1,x: heights from 0 to 15 mm"),
    ("compare one.toml good.ply --sections 7,15.5", "heights from 0 to 15 mm"),
    ("compare wide.toml good.ply --part pinion --sections 15.5", "--sections 15.5: heights from 0 to 15 mm"),
    ("compare one.toml good.ply --sections nan", "heights from 0 to 15 mm"),
    ("compare one.toml good.ply --cycles 5", "--cycles needs --cycles-run"),
    ("compare one.toml good.ply --limit-backlash-mm 1", "--limit-backlash-mm needs --cycles-run"),
    ("compare one.toml good.ply --cycles-run 0", "--cycles-run 0: must be above 0"),
    ("compare one.toml good.ply --cycles-run 9 --cycles 8", "cannot be below --cycles-run 9"),
    ("compare one.toml good.ply --cycles-run 9 --limit-depth-um -1", "--limit-depth-um -1: must be above 0"),
    ("compare one.toml good.ply --cycles-run nan", "--cycles-run nan"),
    ("inspect one.toml good.ply --class 12", "has classes 1 to 11"),
    ("inspect one.toml good.ply --class 13 --edition 1995", "has classes 0 to 12"),
    ("inspect one.toml good.ply --topography 0", "teeth from 1 to 12"),
    ("meshing one.toml", "has one gear"),
    ("meshing --loss 0", "--loss 0: must be above 0"),
    ("meshing --loss 9", "loss 9 mm: must be below"),
    ("meshing --loss 0.1 --teeth one", "--teeth one: whole numbers"),
    ("meshing --loss 0.1 --teeth 13", "the pinion has teeth from 1 to 12"),
    ("meshing --loss 0.1 --part gear --teeth 25", "the gear has teeth from 1 to 24"),
    ("meshing --teeth 3", "--loss, which is not given"),
    ("meshing --loss 0.1 --wear .", "one of them"),
    ("meshing --wear .", "no such file"),
    ("meshing --wear good.ply", "is no NPZ file"),
    ("meshing --centre-distance 100", "sum of the base radii"),
    ("meshing --centre-distance 112", "tips meet roots"),
    ("meshing --centre-distance 140", "do not reach each other"),
    ("meshing --centre-distance -3", "--centre-distance -3: must be above 0"),
]


@pytest.mark.parametrize(("line", "words"), ARGUMENTS, ids=[line[:40] for line, _ in ARGUMENTS])
def test_an_argument_that_cannot_be(place, tmp_path, monkeypatch, line, words):
    monkeypatch.chdir(place)
    refused(run(*line.split(), "--out", tmp_path / "out"), words)
    assert list(tmp_path.iterdir()) == []


def test_teeth_that_no_gear_of_the_design_has_are_refused_before_a_scan_is_read(place, tmp_path, monkeypatch):
    monkeypatch.chdir(place)
    monkeypatch.setattr("gearwear.comparison.closing.measure", lambda *asked: pytest.fail("the scan is read"))
    refused(run("inspect", "one.toml", "good.ply", "--topography", "13", "--out", tmp_path / "out"), "teeth from 1 to 12")
    refused(run("inspect", PAIR, "good.ply", "--topography", "25", "--out", tmp_path / "out"), "--topography 25")


COMMANDS = ("compare one.toml good.ply", "inspect one.toml good.ply", "meshing", "models one.toml")


class TestOutput:
    @pytest.mark.parametrize("line", COMMANDS)
    def test_a_file_in_its_place(self, place, monkeypatch, line):
        monkeypatch.chdir(place)
        refused(run(*line.split(), "--out", "file"), "file: is a file; a folder is needed")
        refused(run(*line.split(), "--out", "file/below"), "cannot be written to")
        assert (place / "file").read_bytes() == b""

    @pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs a folder that nobody can write to")
    @pytest.mark.parametrize("line", ["meshing", "models one.toml"])
    def test_a_folder_that_cannot_be_made(self, place, monkeypatch, line):
        monkeypatch.chdir(place)
        refused(run(*line.split(), "--out", "/proc/nowhere"), "/proc/nowhere: cannot be written to")

    @pytest.mark.parametrize("line", COMMANDS)
    def test_no_right_to_write_is_known_before_the_work(self, place, tmp_path, monkeypatch, line):
        monkeypatch.chdir(place)
        monkeypatch.setattr(os, "access", lambda path, mode: False)
        refused(run(*line.split(), "--out", tmp_path / "out"), "cannot be written to (Permission denied)")
        assert list(tmp_path.iterdir()) == []

    def test_a_full_disc_leaves_what_was_there(self, place, tmp_path, monkeypatch):
        import gearwear.report.files.meshing as writers

        (tmp_path / "meshing.json").write_text("old")

        def full(*_: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(writers, "_write_pictures", full)
        refused(run("meshing", "--out", tmp_path), "No space left on device", "free space")
        assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("meshing.json", "old")]

    @pytest.mark.usefixtures("blank_figures")
    def test_a_folder_where_a_file_should_go(self, place, tmp_path):
        (tmp_path / "meshing.png").mkdir()
        refused(run("meshing", "--out", tmp_path), "meshing.png is a folder there")
        assert [path.name for path in tmp_path.iterdir()] == ["meshing.png"]


@pytest.mark.skipif(not Path("/proc/self/mem").exists(), reason="needs a file that nobody can read")
def test_a_scan_that_may_not_be_read(place, tmp_path):
    (tmp_path / "mem.ply").symlink_to("/proc/self/mem")
    refused(run("compare", place / "one.toml", tmp_path / "mem.ply", "--out", tmp_path / "out"), "mem.ply: cannot be opened")


class TestProfiles:
    """`worn_profiles.npz` from somewhere else."""

    @pytest.fixture
    def arrays(self) -> dict[str, np.ndarray]:
        from gearwear.design import read_design

        gear = read_design(PAIR).gears["pinion"]
        radius = np.linspace(gear.root_radius, gear.tip_radius, 20)
        half_angle = np.broadcast_to(gear.half_angle(radius), (12, 2, 3, 20)).copy()
        return {"radius": radius, "z": np.array([0.0, 7.0, 15.0]), "half_angle": half_angle, "part": np.array("pinion")}

    def told(self, tmp_path: Path, arrays: dict[str, np.ndarray]) -> Said:
        np.savez(tmp_path / "worn_profiles.npz", **arrays)
        return run("meshing", "--wear", tmp_path, "--out", tmp_path / "out", "--quiet")

    @pytest.mark.usefixtures("blank_figures")
    @pytest.mark.parametrize("part", ["pinion", "gear"])
    def test_as_written_they_run(self, tmp_path, arrays, part):
        """Compared by itself, from a design with [gear] alone, the pinion is a "gear": teeth and circles say which of the pair it is."""
        arrays["part"] = np.array(part)
        assert self.told(tmp_path, arrays) == Said(0, "", "")

    @pytest.mark.parametrize(
        ("key", "value", "words"),
        [
            ("part", np.array("wheel"), "is of a 'wheel'"),
            ("half_angle", np.zeros((12, 2, 3, 19)), "of shape (teeth, 2, 3, 20)"),
            ("half_angle", np.full((12, 2, 3, 20), np.nan), "must be finite"),
            ("half_angle", np.zeros((11, 2, 3, 20)), "11 teeth"),
            ("radius", np.linspace(30.0, 44.45, 20), "from r = 30.0000"),
            ("radius", np.linspace(44.45, 30.0, 20), "radius must be a rising row"),
            ("z", np.array(["a", "b", "c"]), "cannot be read"),
            ("z", None, "has no z"),
        ],
    )
    def test_others_do_not(self, tmp_path, arrays, key, value, words):
        if value is None:
            del arrays[key]
        else:
            arrays[key] = value
        refused(self.told(tmp_path, arrays), words, "worn_profiles.npz")

    def test_cut_off(self, tmp_path, arrays):
        np.savez_compressed(tmp_path / "worn_profiles.npz", **arrays)
        data = bytearray((tmp_path / "worn_profiles.npz").read_bytes())
        for at in range(60, 400, 20):
            data[at] ^= 0xFF
        (tmp_path / "worn_profiles.npz").write_bytes(data)
        refused(run("meshing", "--wear", tmp_path, "--out", tmp_path / "out"), "worn_profiles.npz")


# ---- damage at random ----------------------------------------------------------------------------

FUZZ = settings(
    max_examples=3,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


def _thin_example(points: int) -> bytes:
    """The bundled example's scan with fewer of its lines."""
    head, rows = gzip.decompress((EXAMPLE / "scan.ply.gz").read_bytes()).split(b"end_header\n")
    lines = rows.splitlines()
    kept = random.Random(0).sample(lines, points)
    return head.replace(b"vertex %d" % len(lines), b"vertex %d" % points) + b"end_header\n" + b"\n".join(kept) + b"\n"


SCAN = _thin_example(1200)
DESIGN = "\n".join(line.split("#")[0].rstrip() for line in PAIR.read_text().splitlines()).encode()


def damaged(data: st.DataObject, whole: bytes, digits: bool) -> bytes:
    """A few small changes; with `digits` mostly of numbers, which leaves more files that can be read."""
    result = bytearray(whole)
    figures = [i for i, byte in enumerate(whole) if byte in b"0123456789"]
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.sampled_from(figures) if digits else st.integers(0, len(whole) - 1))
        at = min(at, len(result) - 1)
        match "digit" if digits else data.draw(st.sampled_from(["digit", "flip", "cut", "insert", "remove"])):
            case "digit":
                result[at] = data.draw(st.sampled_from(b"0123456789.-"))
            case "flip":
                result[at] ^= 1 << data.draw(st.integers(0, 7))
            case "cut":
                del result[max(at, 1) :]
            case "insert":
                result[at:at] = data.draw(st.binary(min_size=1, max_size=8))
            case "remove":
                del result[at : at + data.draw(st.integers(1, 8))]
    return bytes(result) or b"x"


@pytest.mark.long
@pytest.mark.parametrize(("what", "digits"), list(itertools.product(("design", "scan"), (True, False))))
@given(data=st.data())
@FUZZ
def test_small_changes_are_met_with_a_result_or_one_line(tmp_path, what, digits, data):
    """All stations run on what can still be read; only the page, which takes longest, is left out."""
    design, scan, out = tmp_path / "design.toml", tmp_path / "scan.ply", tmp_path / "out"
    design.write_bytes(damaged(data, DESIGN, digits) if what == "design" else ONE.encode())
    scan.write_bytes(damaged(data, SCAN, digits) if what == "scan" else SCAN)
    shutil.rmtree(out, ignore_errors=True)
    said = run("compare", design, scan, "--out", out, "--quiet", "--no-page")
    assert said.out == ""
    if said.status == 0:
        assert said.err == "" and (out / "report.json").exists()
    else:
        refused(said)
        assert not out.exists()
