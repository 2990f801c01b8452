"""What a store holds is whole, whatever happened to the batch that wrote it."""

from __future__ import annotations

import builtins
import errno
import math
import os
import re
from contextlib import nullcontext
from datetime import datetime

import pytest

from gearwear.errors import InputError
from gearwear.fleet import tables
from gearwear.fleet.keys import Digests, Options, key_of
from gearwear.fleet.outcome import Outcome, State
from gearwear.fleet.reading import read_fleet, trends
from gearwear.fleet.store import Store
from tests.fleet.fleets import contents, report, row, store_of

DONE = Outcome("k", State.DONE, b"report", b"table")


@pytest.fixture
def store(tmp_path):
    with Store(tmp_path / "store").opened():
        pass
    return Store(tmp_path / "store")


def test_states_are_those_of_the_files(store):
    store.publish(DONE)
    store.publish(Outcome("r", State.REFUSED, why="line 3: no points"))
    store.publish(Outcome("f", State.FAILED, why="Traceback\nRuntimeError: gone"))
    assert store.states() == {"k": State.DONE, "r": State.REFUSED, "f": State.FAILED}
    assert (store.why("r", State.REFUSED), store.why("f", State.FAILED)) == ("line 3: no points", "RuntimeError: gone")


@pytest.mark.parametrize("reverse", [False, True])
def test_of_several_states_the_first_counts_in_whatever_order_a_folder_is_listed(store, monkeypatch, reverse):
    for name in ("a.failed", "a.refused", "b.failed", "b.json", "b.refused"):
        (store.folder / name).write_bytes(b"left\n")
    listed = sorted(os.scandir(store.folder), key=lambda entry: entry.name, reverse=reverse)
    monkeypatch.setattr("gearwear.fleet.store.os.scandir", lambda folder: nullcontext(listed))
    assert store.states() == {"a": State.REFUSED, "b": State.DONE}


def test_a_failure_that_succeeds_is_done(store):
    store.publish(Outcome("k", State.FAILED, why="gone"))
    store.publish(DONE)
    assert contents(store.folder) == {"k.json": b"report", "k.parquet": b"table"}


@pytest.mark.parametrize("stopped", [1, 2])
def test_killed_before_a_rename_the_scan_is_not_done(store, monkeypatch, stopped):
    """As a kill at that moment leaves it: the next batch sees a scan to be done, and no leftovers of its own making."""
    calls = []

    def replace(source, target):
        calls.append(target)
        if len(calls) == stopped:
            raise KeyboardInterrupt
        os.rename(source, target)

    monkeypatch.setattr("gearwear.fleet.store.os.replace", replace)
    monkeypatch.setattr("gearwear.fleet.store.os.unlink", lambda name: None)
    with pytest.raises(KeyboardInterrupt):
        store.publish(DONE)
    monkeypatch.undo()
    assert store.states() == {}
    assert list(store.folder.glob(".gearwear-*"))
    with store.opened():
        assert not list(store.folder.glob(".gearwear-*"))
    store.publish(DONE)
    assert store.states() == {"k": State.DONE}


def test_two_batches_are_not_in_one_store(store):
    with store.opened(), pytest.raises(InputError, match=r".*: another batch is at work there"), store.opened():
        pass


def test_what_fails_while_a_batch_has_the_store_open_is_no_fault_of_its_folder(store):
    """As a scheduler that refuses, which was told as a folder that cannot be written to."""
    with pytest.raises(ConnectionRefusedError), store.opened():
        raise ConnectionRefusedError(errno.ECONNREFUSED, "Connection refused")


@pytest.mark.parametrize(
    "write",
    [
        lambda store: store.publish(DONE),
        lambda store: store.publish(Outcome("r", State.REFUSED, why="no points")),
        lambda store: store.keep_digests(Digests()),
        lambda store: store.keep_manifest("a.csv", [(row("G1"), "k1", {})]),
    ],
    ids=["a scan", "a refusal", "digests", "a manifest"],
)
def test_a_full_disk_is_told_as_such(store, monkeypatch, write):
    def full(path, data):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("gearwear.fleet.store.write_data", full)
    with pytest.raises(InputError, match=r".*: cannot be written to \(No space left"):
        write(store)


def test_a_store_that_cannot_be_read_is_told_as_such(store, monkeypatch):
    def closed(folder):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("gearwear.fleet.store.os.scandir", closed)
    with pytest.raises(InputError, match=r".*: cannot be read \(Permission denied\)"):
        store.states()


def test_a_folder_that_is_none_of_a_fleet_is_refused(tmp_path):
    with pytest.raises(InputError, match=r".*: holds no fleet"):
        Store(tmp_path).listed()
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match=r".*: is a file"), Store(tmp_path / "file").opened():
        pass


@pytest.mark.parametrize("left", ["", "key,gear_id\n", "a,b\n"])
def test_a_list_that_lost_its_rows_is_told_by_its_file(store, left):
    store.keep_manifest("a.csv", [(row("G1"), "k1", {})])
    (store.folder / "manifests" / "a.csv").write_text(left)
    with pytest.raises(
        InputError, match=r"a\.csv: is no list that gearwear batch kept \(no row\); the manifest run again would be right"
    ):
        store.listed()


def test_manifests_are_kept_with_keys_and_limits_and_replaced_by_name(store):
    store.keep_manifest("a.csv", [(row("G1"), "k1", {"wear_depth_mm": 0.1}), (row("G2"), "k2", {})])
    store.keep_manifest("b.csv", [(row("G1"), "k1", {"wear_depth_mm": 0.1})])
    assert [(one.key, one.cells["gear_id"], one.limits) for one in store.listed()] == [
        ("k1", "G1", {"wear_depth_mm": 0.1}),
        ("k2", "G2", {}),
    ]
    store.keep_manifest("a.csv", [(row("G3"), "k3", {})])
    assert sorted(one.key for one in store.listed()) == ["k1", "k3"]


@pytest.mark.parametrize("call", ["open", "replace"])
@pytest.mark.parametrize("at", range(2))
def test_a_stop_at_any_call_of_the_system_leaves_no_hidden_file(store, monkeypatch, call, at):
    """Right behind the call, as a signal comes: before whoever made the file knows that it was made."""
    where, calls = (os, iter(range(1000))) if call == "replace" else (builtins, iter(range(1000)))
    real = getattr(where, call)

    def stopped(*arguments, **more):
        result = real(*arguments, **more)
        if next(calls) == at:
            if call == "open":
                result.close()
            raise KeyboardInterrupt
        return result

    monkeypatch.setattr(where, call, stopped)
    with pytest.raises(KeyboardInterrupt):
        store.publish(DONE)
    monkeypatch.undo()
    assert not list(store.folder.glob(".gearwear-*"))
    assert store.states() in ({}, {"k": State.DONE})


def kept(tmp_path):
    """A store of one scan."""
    return store_of(tmp_path / "kept", [(row("G1", datetime(2026, 1, 1), 1e6), report())], {"wear_depth_mm": 0.1})


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("gear_id", "gear"),
        ("0.1", "much"),
        ("0.1", "1e999"),
        ("0.1", "1e308"),
        ("0.1", "-1e308"),
        ("1000000", "many"),
        ("2026-01-01", "0001-01-01"),
        ("2026-01-01", "yesterday"),
        ("key", "k"),
        ("\n", "\n" + "1" * 200_000 + "\n"),
        ("mm", "mm,,,,,,,,,,,"),
    ],
    ids=[
        "no gear",
        "a limit in words",
        "a limit beyond numbers",
        "one whose square is",
        "one below zero",
        "cycles in words",
        "a year without scanners",
        "a date in words",
        "no key",
        "a field too long",
        "too many fields",
    ],
)
def test_a_kept_manifest_that_was_changed_is_refused_in_one_line(tmp_path, old, new):
    store = kept(tmp_path)
    (file,) = (store.folder / "manifests").iterdir()
    file.write_text(file.read_text().replace(old, new))
    with pytest.raises(InputError) as caught:
        trends(read_fleet(store))
    assert str(file) in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("damage", ["cut", "empty", "missing", "words for numbers", "beyond numbers"])
def test_a_table_that_was_damaged_is_refused_by_name(tmp_path, damage):
    """The one that is: those beside it are right."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    store = kept(tmp_path)
    (good,) = store.folder.glob("*.parquet")
    store.keep_manifest("other.csv", [(row("G2"), "k2", {})])
    table = pq.read_table(good)
    store.publish(Outcome("k2", State.DONE, b"{}", good.read_bytes()))
    bad = store.folder / "k2.parquet"
    match damage:
        case "cut":
            bad.write_bytes(good.read_bytes()[:-100])
        case "empty":
            bad.write_bytes(b"")
        case "missing":
            bad.unlink()
        case "words for numbers" | "beyond numbers":
            at = table.column_names.index("value")
            pq.write_table(table.set_column(at, "value", pa.array(["x" if "words" in damage else -1e308] * len(table))), bad)
    with pytest.raises(InputError) as caught:
        read_fleet(store)
    assert str(bad) in str(caught.value) and "would be right" in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("at", [0, 1, 20, 32])
def test_the_damaged_one_of_many_tables_is_found_in_few_reads(tmp_path, monkeypatch, at):
    """Of n tables in log2 n + 1 reads beside the one that failed: one after the other, each with all before it, they were n² / 2 files."""
    store = store_of(tmp_path / "s", [(row(f"G{i}"), report()) for i in range(33)])
    files, read = sorted(store.folder.glob("*.parquet")), []
    files[at].write_bytes(b"")

    def counted(database, query, some, scope):
        read.append(len(some))
        return rows_of(database, query, some, scope)

    rows_of = tables._rows
    monkeypatch.setattr(tables, "_rows", counted)
    with pytest.raises(InputError, match=re.escape(str(files[at]))):
        tables.read_tables(files, "gear")
    assert len(read) <= 1 + math.ceil(math.log2(33))


def test_no_key_is_a_device_of_windows_or_another_in_other_letters():
    """NUL.json is a device there whatever follows the dot, and A.json is a.json on a Mac."""
    keys = [key_of(row(gear_id=name), ["x"], Options(), "1") for name in ("nul.1", "NUL.1", "a", "A", "é", "")]
    assert not any("." in key for key in keys)
    assert len({key.lower() for key in keys}) == len(keys)
