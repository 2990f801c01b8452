"""Input made on purpose: one line, status 2, and neither time nor memory without bound."""

from __future__ import annotations

import gzip
import itertools
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pytest

from gearwear.design import read_design
from gearwear.memory import POINT
from tests.commands.doors import ONE, PAIR, ROOT, Said, run, thinner_example
from tests.commands.test_bad_input import refused
from tests.hostile.made import DESIGNS, SCANS, npz, ply
from tests.scan.writers import ball, stl, torus, xyz
from tests.scan.writers import ply as ply_of

pytestmark = pytest.mark.long

SECONDS, BYTES = 5.0, 1e9
"""What a file that is refused may take: of processor time, and of memory beyond what the process began with."""
FORK = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork, to measure a command by itself")


def bounded(*arguments: object) -> Said:
    """A command in a process of its own; its time and memory are held against the bounds.

    A forked process begins with what the tests before it have left in memory; that is none of the command's doing.
    """
    import resource  # not on Windows, where these tests are skipped

    import gearwear.comparison.stations
    import gearwear.identify.survey  # noqa: F401 - loaded here once, not in every process

    with tempfile.TemporaryFile() as told:
        child = os.fork()
        if child == 0:
            said, begun = Said(70, "", ""), bytes_of(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
            try:
                said = run(*arguments)
            except BaseException as error:
                said = Said(70, "", f"{type(error).__name__}: {error}")
            finally:
                told.write(f"{begun}\0{said.status}\0{said.out}\0{said.err}".encode("utf-8", "backslashreplace"))
                told.flush()
                os._exit(0)
        _, _, used = os.wait4(child, 0)
        told.seek(0)
        begun, status, out, err = told.read().decode().split("\0")
    assert used.ru_utime + used.ru_stime < SECONDS
    assert bytes_of(used.ru_maxrss) - int(begun) < BYTES
    return Said(int(status), out, err)


def bytes_of(most_memory: int) -> int:
    """The most memory that a process has held, in bytes; Linux counts it in kilobytes."""
    return most_memory * (1 if sys.platform == "darwin" else 1024)


@pytest.fixture
def design(tmp_path: Path) -> Path:
    (tmp_path / "one.toml").write_text("[gear]\nteeth = 12\nmodule = 6.35\nface_width = 15\n")
    return tmp_path / "one.toml"


@FORK
class TestMadeOnPurpose:
    @pytest.mark.parametrize("name", SCANS)
    @pytest.mark.parametrize("command", ["compare", "design"])
    def test_a_scan(self, tmp_path, design, name, command):
        (tmp_path / name).write_bytes(SCANS[name]())
        before = [design] if command == "compare" else []
        said = bounded(command, *before, tmp_path / name, *(["--out", tmp_path / "out"] if before else []))
        refused(said, str(tmp_path / name))
        assert not (tmp_path / "out").exists()

    @pytest.mark.parametrize("name", DESIGNS)
    @pytest.mark.parametrize("command", ["models", "meshing"])
    def test_a_design(self, tmp_path, name, command):
        (tmp_path / name).write_bytes(DESIGNS[name]())
        refused(bounded(command, tmp_path / name, "--out", tmp_path / "out"), str(tmp_path / name))

    @pytest.mark.parametrize(
        ("key", "value", "words"),
        [
            ("radius", ("<f8", "(1000000000000,)"), "of shape"),
            ("radius", ("<f8", "(-1,)"), "npz"),
            ("z", ("<f8", "(400000000,)"), "of shape"),
            ("z", np.array([0.0, 7.0, 1e300]), "z goes from"),
            ("half_angle", ("<f8", "(12, 2, 3, 1000000000000)"), "of shape"),
            ("half_angle", ("<f8", "(10000000000, 2, 3, 20)"), "10,000,000,000 teeth"),
            ("half_angle", ("|O", "(12, 2, 3, 20)"), "half_angle holds object"),
            ("half_angle", np.full((12, 2, 3, 20), 0.1 + 0.1j), "half_angle holds complex128"),
            ("radius", np.arange(20) > 10, "radius holds bool"),
            ("part", ("<U100000000", "()"), "part holds"),
            ("half_angle", -1.0, "half_angle goes from"),
            ("half_angle", 50.0, "half_angle goes from"),
            ("half_angle", 1e300, "half_angle goes from"),
        ],
    )
    def test_profiles(self, tmp_path, key, value, words):
        gear = read_design(PAIR).gears["pinion"]
        radius = np.linspace(gear.root_radius, gear.tip_radius, 20)
        half_angle = np.broadcast_to(gear.half_angle(radius), (12, 2, 3, 20)).copy()
        arrays = {"radius": radius, "z": np.array([0.0, 7.0, 15.0]), "half_angle": half_angle, "part": np.array("pinion")}
        (tmp_path / "a.npz").write_bytes(npz(**{**arrays, key: value * half_angle if isinstance(value, float) else value}))
        refused(bounded("meshing", "--wear", tmp_path / "a.npz", "--out", tmp_path / "out"), "a.npz", words)

    def test_profiles_that_belong_together_and_are_too_many(self, tmp_path):
        arrays = {
            "radius": ("<f8", "(1000,)"), "z": ("<f8", "(1000000,)"), "half_angle": ("<f8", "(12, 2, 1000000, 1000)"), "part": np.array("pinion"),
        }  # fmt: skip
        (tmp_path / "a.npz").write_bytes(npz(**arrays))
        refused(bounded("meshing", "--wear", tmp_path / "a.npz", "--out", tmp_path / "out"), "a.npz", "GB of memory")

    @pytest.mark.parametrize(
        "band",
        [
            f"[profile]\nroll_mm = [{10**400}, 2]\nlower_um = [0, 0]\nupper_um = [1, 1]\n",
            "[helix]\nz_mm = [1, 14]\nlower_um = [-1e308, -1e308]\nupper_um = [1e308, 1e308]\n",
            "[helix]\nz_mm = [1, 1e308]\nlower_um = [0, 0]\nupper_um = [1, 1]\n",
            "[helix]\nz_mm = [nan, 14]\nlower_um = [0, 0]\nupper_um = [1, 1]\n",
            ".".join(["a"] * 20_000) + " = 1",
        ],
        ids=["ten_to_400", "limits", "place", "nan", "dotted"],
    )
    def test_a_k_band_is_refused_before_the_scan_is_looked_for(self, tmp_path, band):
        (tmp_path / "band.toml").write_text(band)
        said = bounded("inspect", PAIR, tmp_path / "no_such.ply", "--k-band", tmp_path / "band.toml", "--out", tmp_path / "out")
        refused(said, "band.toml")


@FORK
class TestMemory:
    def test_a_scan_is_refused_by_its_count(self, tmp_path, design):
        """Just above and just below what is allowed; the file is the same, only the option differs."""
        (tmp_path / "a.ply").write_bytes(ply_of(ball(5000)))
        refused(bounded("compare", design, tmp_path / "a.ply", "--memory", 4999 * POINT / 1e9), "5,000 points", "memory = 1 GB")
        said = bounded("compare", design, tmp_path / "a.ply", "--memory", 5001 * POINT / 1e9)
        refused(said, "does not fit the design")

    @pytest.mark.parametrize("amount", ["0", "-1", "nan", "inf", "much"])
    def test_what_is_no_amount(self, tmp_path, design, amount):
        refused(bounded("compare", design, "a.ply", f"--memory={amount}"), "memory")

    @pytest.mark.parametrize("name", ["a.stl", "a.xyz", "a.ply", "a.obj"])
    def test_what_is_not_refused_stays_within_it(self, tmp_path, name):
        """The bytes said of a point or a triangle are what it takes at most: measured while a file is read."""
        points = ball(60_000)
        data = {
            "a.xyz": lambda: xyz(points), "a.ply": lambda: ply_of(points), "a.stl": lambda: stl(*torus(170, 170)),
            "a.obj": lambda: b"v " + xyz(points).strip().replace(b"\n", b"\nv "),
        }  # fmt: skip
        (tmp_path / name).write_bytes(data[name]())
        code = (
            "import sys, tracemalloc\nfrom gearwear.scan import read_one\nfrom gearwear import memory\n"
            "asked = []\ncheck = memory._allowed\n"
            "import gearwear.scan.reading as r\n"
            "def least():\n"
            "    low, high = 1e4, 1e10\n"
            "    while high > 1.02 * low:\n"
            "        middle = (low * high) ** 0.5\n"
            "        with memory.allowing(middle / 1e9):\n"
            "            try:\n                read_one(sys.argv[1]); high = middle\n"
            "            except r.InputError: low = middle\n"
            "    return high\n"
            "read_one(sys.argv[1])\ntracemalloc.start()\nread_one(sys.argv[1])\npeak = tracemalloc.get_traced_memory()[1]\ntracemalloc.stop()\n"
            "print(peak, least())\n"
        )
        told = subprocess.run([sys.executable, "-c", code, tmp_path / name], capture_output=True, text=True, cwd=ROOT, check=True)
        peak, allowed = (float(word) for word in told.stdout.split())
        assert peak < allowed


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="needs a file system that takes any bytes as a name")
@pytest.mark.usefixtures("blank_figures")
def test_names_that_are_no_text(tmp_path):
    """They work: the report has them with the bytes that are no text written out."""
    scan, drawing = tmp_path / os.fsdecode(b"m\xfcll.ply.gz"), tmp_path / os.fsdecode(b"d\xff.toml")
    scan.write_bytes(gzip.compress(thinner_example(tmp_path, 15).read_bytes()))
    drawing.write_text(ONE)
    said = run("compare", drawing, scan, "--no-loop", "--out", tmp_path / os.fsdecode(b"out\xfe"), "--quiet")
    assert said == Said(0, "", "")
    assert "m\\\\xfcll.ply.gz" in (tmp_path / os.fsdecode(b"out\xfe") / "report.json").read_text(encoding="utf-8")


@pytest.mark.skipif(sys.platform == "win32", reason="by the shell")
class TestStandardOutput:
    WHERE = ("> /dev/full", ">&-", ">&- 2>&-", "| head -c 1 > {out}.head; exit ${{PIPESTATUS[0]}}")
    # What a command prints goes one way out whatever it is; one that writes files as well is tried where it learns of it late, and at once.
    TRIED = (*itertools.product(("paper", "compare --help"), WHERE), *itertools.product(("meshing --out {out}",), WHERE[:2]))

    @pytest.mark.parametrize(("command", "where"), TRIED)
    def test_full_closed_or_left(self, tmp_path, command, where):
        if "/dev/full" in where and not Path("/dev/full").exists():
            pytest.skip("no /dev/full here")
        line = f"{sys.executable} -m gearwear {command} {where}".format(out=tmp_path / "out")
        told = subprocess.run(["bash", "-c", line], capture_output=True, text=True, cwd=ROOT, check=False)
        if "head" in where:
            assert (told.returncode, told.stderr) == (0, "")
            return
        assert told.returncode == 2
        assert told.stdout == ""
        if "2>&-" not in where:
            assert re.fullmatch(r"gearwear: standard output cannot be written to \(.*\n", told.stderr)

    def test_quiet_needs_none(self, tmp_path):
        line = f"{sys.executable} -m gearwear meshing --quiet --out {tmp_path / 'out'} >&-"
        told = subprocess.run(["bash", "-c", line], capture_output=True, text=True, cwd=ROOT, check=False)
        assert (told.returncode, told.stderr) == (0, "")
        assert (tmp_path / "out" / "meshing.json").exists()


def test_a_file_that_is_none(tmp_path, design):
    """A pipe that nobody writes to would be waited for without end."""
    if not hasattr(os, "mkfifo"):
        pytest.skip("no named pipes here")
    os.mkfifo(tmp_path / "pipe.ply")
    begun = time.monotonic()
    refused(run("compare", design, tmp_path / "pipe.ply"), "pipe.ply", "device or a pipe")
    assert time.monotonic() - begun < SECONDS


def test_a_message_stays_a_line(tmp_path):
    said = run("x" * 100_000)
    refused(said)
    assert len(said.err) < 7000


def test_the_parts_that_are_counted_are_those_of_the_header(tmp_path):
    """An element without properties is refused only where it promises rows."""
    from gearwear.scan.ply import read_ply

    assert len(read_ply(ply("element foo 0\n")).points) == 0


@FORK
@pytest.mark.parametrize("name", ["no_property.ply", "instances.glb", "bomb.laz", "brackets.xyz"])
@pytest.mark.parametrize("command", ["inspect --half upper", "compare --before"])
def test_a_scan_at_the_doors_that_came_later(tmp_path, name, command):
    """A half of a double helical gear; and of two scans the second one."""
    (tmp_path / name).write_bytes(SCANS[name]())
    if command == "compare --before":
        words = [PAIR, thinner_example(tmp_path, 10), "--before", tmp_path / name, "--no-loop"]
    else:
        words = [ROOT / "models" / "double_helical.toml", tmp_path / name, "--half", "upper", "--part", "pinion"]
    said = bounded(command.split()[0], *words, "--out", tmp_path / "out")
    refused(said, str(tmp_path / name))
    assert not (tmp_path / "out").exists()


def test_a_logo_is_refused_before_the_scan_is_looked_for(tmp_path):
    (tmp_path / "logo.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(3_000_000))
    (tmp_path / "design.toml").write_text('[gear]\nteeth = 12\nmodule = 6.35\nface_width = 15\n[report]\nlogo = "logo.png"\n')
    refused(
        run("compare", tmp_path / "design.toml", tmp_path / "no_such.ply", "--out", tmp_path / "out"),
        "logo.png",
        "larger than 2 MB",
    )
