"""A batch: what is done, refused and failed, what is done again, and that nothing depends on who does the work."""

from __future__ import annotations

import json
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from gearwear.fleet.batch import run_batch
from gearwear.fleet.keys import Options
from gearwear.fleet.outcome import Outcome, State
from gearwear.fleet.store import Store
from gearwear.fleet.task import run
from tests.commands.doors import run as command
from tests.fleet.fleets import contents, nobody, sections

MEMORY = 4e9


def crew(work):
    """Workers that do this, one scan after the other, in this process."""

    @contextmanager
    def here(jobs):
        yield map(work, jobs)

    return here


@cache
def once(job):
    """What the work comes to, which depends on the job alone: done once for tests of who does it and when."""
    return run(job)


def quiet(tally, row, outcome):
    """Told how far the batch is."""


def batch(manifest: Path, store: Path, workers=None, options=None):
    return run_batch(manifest, Store(store), workers or crew(run), options or Options(), MEMORY, quiet)


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    """Two sections and one file that is no scan, compared once in this process."""
    folder = tmp_path_factory.mktemp("fleet")
    manifest = sections(folder)
    tally = batch(manifest, folder / "store", crew(once))
    return manifest, folder / "store", tally


def test_each_scan_has_a_report_and_a_table_and_what_is_no_scan_has_its_line(fleet):
    manifest, store, tally = fleet
    assert (tally.total, tally.done, tally.refused, tally.failed) == (3, 2, 1, 0)
    names = sorted(contents(store))
    assert [Path(name).suffix for name in names] == [".json", ".parquet", ".json", ".parquet", ".refused"]
    report = json.loads((store / names[0]).read_text(encoding="utf-8"))
    assert report["schema"] == "gearwear.report/1"
    assert (report["scan"]["files"], report["design"]["source"]) == (["s0.xyz"], "design.toml")
    assert report["files"] == names[:2]
    assert (store / names[4]).read_text().startswith("line 4: ")
    table = pq.read_table(store / names[1]).to_pydict()
    assert set(table["site"]) == {"hall 1"}
    assert set(table["gear_id"]) == {"G0"}
    assert "wear_area_mm2" in table["quantity"]
    assert str(manifest.parent) not in (store / names[0]).read_text(encoding="utf-8")


def test_with_nothing_to_do_nobody_is_called_and_nothing_read(fleet, monkeypatch):
    manifest, store, _ = fleet
    before = contents(store)
    tally = batch(manifest, store, nobody)
    assert (tally.done, tally.refused, tally.to_do) == (2, 1, 0)
    assert contents(store) == before


def test_a_thousand_scans_with_nothing_to_do_are_only_looked_at(tmp_path, monkeypatch):
    """Not by the clock: files are looked at, not read. benchmarks/fleet has the seconds."""
    (tmp_path / "design.toml").write_text("[gear]\nteeth = 12\nmodule = 6.35\nface_width = 15\n")
    lines = ["gear_id,design,scans"]
    for i in range(1000):
        (tmp_path / f"s{i}.ply").write_text(str(i))
        lines.append(f"G{i},design.toml,s{i}.ply")
    (tmp_path / "fleet.csv").write_text("\n".join(lines) + "\n")
    monkeypatch.setattr("gearwear.fleet.keys.FRESH", -10.0)  # the files are as good as old
    monkeypatch.setattr("gearwear.fleet.store.os.fsync", lambda number: None)  # 2000 files: the disk is not what is tested
    tally = batch(tmp_path / "fleet.csv", tmp_path / "store", crew(lambda job: Outcome(job.key, State.DONE, b"{}", b"")))
    assert tally.done == 1000
    read = []
    monkeypatch.setattr("gearwear.fleet.keys.file_digest", lambda path: read.append(path))
    assert batch(tmp_path / "fleet.csv", tmp_path / "store", nobody).done == 1000
    assert read == []


def test_a_driver_that_is_killed_has_lost_the_scans_in_flight(fleet, tmp_path):
    manifest, store, _ = fleet

    def killed_at_second(job):
        if job.row.gear_id == "G1":
            raise KeyboardInterrupt
        return once(job)

    with pytest.raises(KeyboardInterrupt):
        batch(manifest, tmp_path / "store", crew(killed_at_second))
    assert [name[:2] for name in contents(tmp_path / "store")] == ["G0", "G0"]
    tally = batch(manifest, tmp_path / "store", crew(once))
    assert tally.to_do == 2
    assert contents(tmp_path / "store") == contents(store)


def test_what_failed_is_tried_again_and_what_was_refused_is_not(fleet, tmp_path):
    manifest, store, _ = fleet
    tried = []

    def fails(job):
        tried.append(job.row.gear_id)
        return once(job) if job.row.gear_id == "G9" else Outcome(job.key, State.FAILED, why="gone")

    first = batch(manifest, tmp_path / "store", crew(fails))
    assert (first.failed, first.refused) == (2, 1)
    tried.clear()
    second = batch(manifest, tmp_path / "store", crew(fails))
    assert tried == ["G0", "G1"]
    assert (second.failed, second.refused, second.to_do) == (2, 1, 2)
    batch(manifest, tmp_path / "store", crew(once))
    assert contents(tmp_path / "store") == contents(store)


@pytest.mark.parametrize(("change", "again"), [
    (lambda folder: (folder / "s0.xyz").write_text((folder / "s1.xyz").read_text()), ["G0"]),
    (lambda folder: (folder / "fleet.csv").write_text((folder / "fleet.csv").read_text().replace("G1,", "H1,")), ["H1"]),
    (lambda folder: (folder / "design.toml").write_text((folder / "design.toml").read_text() + "tip_chamfer = 0.1\n"), ["G0", "G1", "G9"]),
    (lambda folder: (folder / "design.toml").write_text((folder / "design.toml").read_text() + "[limits]\nwear_depth_mm = 0.1\n"), []),
    (lambda folder: (folder / "bad.xyz").write_text("still none\n"), ["G9"]),
])  # fmt: skip
def test_what_changed_is_done_again_and_nothing_else(tmp_path, change, again):
    manifest, done = sections(tmp_path), []

    def noted(job):
        done.append(job.row.gear_id)
        return Outcome(job.key, State.REFUSED if job.row.gear_id == "G9" else State.DONE, b"{}", b"", "line")

    batch(manifest, tmp_path / "store", crew(noted))
    done.clear()
    change(tmp_path)
    batch(manifest, tmp_path / "store", crew(noted))
    assert done == again


def test_other_options_are_another_result(tmp_path):
    manifest = sections(tmp_path, 1)
    work = crew(lambda job: Outcome(job.key, State.DONE, b"{}", b""))
    batch(manifest, tmp_path / "store", work)
    assert batch(manifest, tmp_path / "store", work, Options(loop=False)).to_do == 2


def test_more_than_the_memory_that_is_allowed_is_a_failure_and_not_bad_input(tmp_path):
    """It is tried again, with more."""
    manifest = sections(tmp_path, 1)
    tally = run_batch(manifest, Store(tmp_path / "store"), crew(run), Options(), 2e5, quiet)
    assert (tally.failed, tally.done) == (1, 0)
    tally = batch(manifest, tmp_path / "store", crew(lambda job: Outcome(job.key, State.DONE, b"{}", b"")))
    assert (tally.to_do, tally.done, tally.refused) == (1, 1, 1)


def test_a_file_that_changes_while_the_batch_runs_fails_and_leaves_no_result(fleet, tmp_path):
    manifest = sections(tmp_path, 1)

    def changed(job):
        (tmp_path / "s0.xyz").write_text("1 2\n")
        return run(job)

    batch(manifest, tmp_path / "store", crew(changed))
    (name,) = (name for name in contents(tmp_path / "store") if name.startswith("G0"))
    assert name.endswith(".failed")
    assert "s0.xyz: is not the same" in (tmp_path / "store" / name).read_text()


def test_the_command_in_this_process(fleet, tmp_path):
    manifest, store, _ = fleet
    said = command("batch", manifest, "--out", tmp_path / "store", "--workers", "0", "--verbose")
    assert said.status == 0
    assert said.out.startswith("3 scans: 2 done, 1 refused, 0 failed\n! G9 2026-01-09 refused: line 4: ")
    assert [line.split(",")[0] for line in said.err.splitlines()] == [
        "1/3 done G0 2026-01-01",
        "2/3 done G1 2026-01-02",
        "3/3 refused G9 2026-01-09",
    ]
    assert contents(tmp_path / "store") == contents(store)
    again = command("batch", manifest, "--out", tmp_path / "store", "--workers", "0", "--quiet")
    assert (again.status, again.out) == (0, "")
    assert again.err.startswith("! G9 2026-01-09 refused: line 4: ")  # an error, and no word of what went well


def test_the_end_says_why_in_full_and_what_columns_mean_nothing_to_it(fleet):
    manifest, store, _ = fleet
    said = command("batch", manifest, "--out", store, "--workers", "0")
    assert "…" not in said.out and max(map(len, said.out.splitlines())) <= 80
    (why,) = (path.read_text(encoding="utf-8").strip() for path in store.glob("*.refused"))
    assert "".join(why.split()) in "".join(said.out.split())
    assert "Further columns, kept as they are: site\n" in said.out


def test_a_column_that_may_be_meant_for_another_is_asked_for(tmp_path, monkeypatch):
    """`unit` was kept as it is, and the scans of a list in inches were read in millimetres; so with `cycles` and the order of the trend."""
    monkeypatch.setattr("gearwear.fleet.task.run", lambda job: Outcome(job.key, State.REFUSED, why="line"))
    lines = (
        sections(tmp_path, 0)
        .read_text(encoding="utf-8")
        .replace("site", "unit,Cycles,inspection,room")
        .replace("hall 2", "in,5,May,hall 2")
    )
    (tmp_path / "fleet.csv").write_text(lines, encoding="utf-8")
    said = command("batch", tmp_path / "fleet.csv", "--out", tmp_path / "store", "--workers", "0").out
    assert "Further columns, kept as they are: unit (units?), Cycles (cycles_run?)," in said
    assert "inspection (inspected?), room\n" in said


def test_what_another_list_of_the_store_refused_is_not_told_of_this_one(tmp_path, monkeypatch):
    """A tally of "1 scan: 1 done, 0 refused" stood over the refusals of all lists, each "line 2"."""
    good = "gear_id,design,scans\nG0,design.toml,s0.xyz\n"
    (sections(tmp_path, 1).parent / "good.csv").write_text(good, encoding="utf-8")
    monkeypatch.setattr("gearwear.fleet.task.run", lambda job: Outcome(job.key, State.REFUSED, why=f"of {job.row.gear_id}"))
    command("batch", tmp_path / "fleet.csv", "--out", tmp_path / "store", "--workers", "0")
    said = command("batch", tmp_path / "good.csv", "--out", tmp_path / "store", "--workers", "0").out
    assert said.startswith("1 scan: 0 done, 1 refused, 0 failed\n! G0 refused: of G0\n")
    assert "G9" not in said and "site" not in said


def test_a_list_in_the_place_of_another_says_what_it_leaves_out(tmp_path, monkeypatch):
    """One a month, all called fleet.csv: the earlier months were gone from the trend, and nothing said so."""
    monkeypatch.setattr("gearwear.fleet.task.run", lambda job: Outcome(job.key, State.REFUSED, why="line"))
    for month in ("1", "2"):
        (tmp_path / month).mkdir()
        lines = (
            sections(tmp_path / month, 2 if month == "1" else 1).read_text(encoding="utf-8").replace("2026-01", f"2026-0{month}")
        )
        (tmp_path / month / "fleet.csv").write_text(lines, encoding="utf-8")
    first, again, second = (
        command("batch", tmp_path / month / "fleet.csv", "--out", tmp_path / "store", "--workers", "0") for month in "112"
    )
    assert "earlier list" not in first.out + again.out
    assert "! 3 scans of the earlier list of this name are not in it" in second.out


@pytest.mark.parametrize(("arguments", "said"), [
    (["--workers", "2", "--scheduler", "tcp://x:1"], "--workers and --scheduler both say who works"),
    (["--workers", "-1"], "--workers -1: a number from 0 on"),
    (["--memory", "0"], "memory = 0 GB"),
])  # fmt: skip
def test_wrong_options(tmp_path, arguments, said):
    found = command("batch", sections(tmp_path, 1), "--out", tmp_path / "store", *arguments)
    assert (found.status, said in found.err, found.err.count("\n")) == (2, True, 1)
    assert not (tmp_path / "store").exists()
