"""One scan in two rows of a list: said, and not refused."""

from __future__ import annotations

from tests.commands.doors import run
from tests.fleet.fleets import sections

HEAD = "gear_id,inspected,design,scans\n"


def test_a_scan_listed_for_two_gears_is_said_with_both_lines(tmp_path):
    """No matter its name; the same gear may list it again, and two files that are not there are not the same."""
    sections(tmp_path, 1)
    for name, said in (("a", "no numbers"), ("b", "no numbers"), ("c", "none either")):
        (tmp_path / f"{name}.xyz").write_text(f"{said}\n")
    rows = [("G0", "2025-01-01", "a"), ("G0", "2025-02-01", "a"), ("G1", "2025-01-01", "b"), ("G2", "2025-01-01", "c")]
    rows += [("G3", "2025-01-01", "lost"), ("G4", "2025-01-01", "gone")]
    text = HEAD + "".join(f"{gear},{day},design.toml,{scan}.xyz\n" for gear, day, scan in rows)
    (tmp_path / "fleet.csv").write_text(text)

    said = run("batch", str(tmp_path / "fleet.csv"), "--out", str(tmp_path / "store"), "--workers", "0")

    assert said.status == 0
    out = " ".join(said.out.split())
    assert "6 scans: 0 done, 6 refused" in out
    assert out.count("are the same scan") == 1
    assert "! lines 2 and 4 of the list, gears G0 and G1, are the same scan: b.xyz" in out
