"""The list of scans: what is read, and each refusal with its line."""

from __future__ import annotations

from datetime import datetime

import pytest

from gearwear.errors import InputError
from gearwear.fleet.manifest import read_manifest

FULL = """\
gear_id,inspected,design,scans,part,units,before,cycles_run,operator,repeat,site
# two views, and one before
G1,2026-03-01,d.toml,a.ply;b.ply,gear,in,new.ply,2.5e6,Ann,1,hall 2

"G,2",2026-03-01T14:30,d.toml,c.ply,,,,,,,
"""


@pytest.fixture
def read(tmp_path):
    def written(text: str, encoding: str = "utf-8"):
        (tmp_path / "fleet.csv").write_bytes(text.encode(encoding))
        return read_manifest(tmp_path / "fleet.csv")

    return written


def test_every_column_is_read_and_further_ones_are_kept(read):
    first, second = read(FULL)
    assert (first.gear_id, first.scans, first.before) == ("G1", ("a.ply", "b.ply"), ("new.ply",))
    assert (first.part, first.units, first.cycles_run, first.operator, first.repeat) == ("gear", "in", 2.5e6, "Ann", "1")
    assert first.more == (("site", "hall 2"),)
    assert (first.line, second.line) == (3, 5)
    assert (second.gear_id, second.inspected, second.units, second.part) == ("G,2", datetime(2026, 3, 1, 14, 30), "mm", None)


@pytest.mark.parametrize(("sign", "encoding"), [(";", "utf-8-sig"), ("\t", "utf-16"), (",", "utf-8")])
def test_tables_as_spreadsheets_write_them(read, sign, encoding):
    text = sign.join(["gear_id", "design", "scans"]) + "\r\n" + sign.join(["Ä1", "d.toml", '"a.ply;b.ply"']) + "\r\n"
    (row,) = read(text, encoding)
    assert (row.gear_id, row.scans) == ("Ä1", ("a.ply", "b.ply"))


def test_dates_and_numbers_of_a_spreadsheet_with_a_decimal_comma(read):
    head = "gear_id;inspected;design;scans;cycles_run;operator\r\n"
    rows = read(
        head
        + "Räder/12, links;01.03.2026;d.toml;s 0.xyz;1,5E+06;Jörg\r\n齿轮 7;1.12.2026 14:30;d.toml;s.xyz;1500000,5;\r\n;;;;;\r\n",
        "utf-8-sig",
    )
    assert [(row.gear_id, row.inspected, row.cycles_run) for row in rows] == [
        ("Räder/12, links", datetime(2026, 3, 1), 1.5e6), ("齿轮 7", datetime(2026, 12, 1, 14, 30), 1500000.5)
    ]  # fmt: skip


def test_capitals_blanks_and_hyphens_of_a_column_do_not_count(read):
    """A column "Inspected" was kept as a further column: every date was lost, and the trend had no order."""
    (row,) = read("Gear ID,Inspected,DESIGN,Scans,Cycles-run, Operator ,Site\nG,2026-03-01,d,s,5,Ann,Hall\n")
    assert (row.gear_id, row.inspected, row.cycles_run, row.operator) == ("G", datetime(2026, 3, 1), 5.0, "Ann")
    assert row.more == (("Site", "Hall"),)


def test_remarks_with_quotes_and_a_gear_whose_name_begins_with_a_hash(read):
    rows = read('# at 20 C, "cold" room\ngear_id,design,scans\nG1,d,a\n  # "half\nG2,d,b\n"#12",d,c\n#13,d,e\n')
    assert [(row.line, row.gear_id) for row in rows] == [(3, "G1"), (5, "G2"), (6, "#12")]


HEAD = "gear_id,inspected,design,scans,part,units,cycles_run,repeat\n"


@pytest.mark.parametrize(("text", "said"), [
    ("", "is empty"),
    (HEAD, "has no row below its column names"),
    ("gearid,design,scans\n", "line 1 names no column gear_id ('gearid'?)"),
    ("gear_id,design,scans,value\nG,d,s,1\n", "line 1: the store writes a column 'value' itself"),
    ("gear_id,design,scans,x,x\nG,d,s,1,2\n", "line 1 names 'x' 2 times"),
    (HEAD + "G,,d.toml,s.ply\n", "line 2 has 4 cells and line 1 names 8 columns"),
    (HEAD + ",,d.toml,s.ply,,,,\n", "line 2: gear_id is empty"),
    (HEAD + "G,,d.toml,;,,,,\n", "line 2: scans = ';': at least one file"),
    (HEAD + "G,1/3/2026,d.toml,s.ply,,,,\n", "line 2: inspected = '1/3/2026': a date as 2026-03-01"),
    (HEAD + "G,31.2.2026,d.toml,s.ply,,,,\n", "line 2: inspected = '31.2.2026': a date as 2026-03-01"),
    ("Gear,design,scans\n", "line 1 names no column gear_id ('Gear'?)"),
    (HEAD.replace("repeat", "Part"), "line 1 names 'part' 2 times"),
    (HEAD + 'G,,d.toml,s.ply,,,"1,500",\n', "line 2: cycles_run = '1,500': a number from 0 on, such as 2.5e6 or 2500000"),
    (HEAD + "G,,d.toml,s.ply,,,1.500.000,\n", "cycles_run = '1.500.000'"),
    (HEAD + "G,2026-03-01T10:00+01:00,d.toml,s.ply,,,,\n", "local time without a zone"),
    (HEAD + "G,0001-01-01,d.toml,s.ply,,,,\n", "line 2: inspected = '0001-01-01': a year from 1900 to 2200 would be right"),
    (HEAD + "G,9999-12-30T23:00,d.toml,s.ply,,,,\n", "line 2: inspected = '9999-12-30T23:00': a year from 1900 to 2200"),
    (HEAD + "G,,d.toml,s.ply,wheel,,,\n", "line 2: part = 'wheel': pinion, gear or nothing"),
    (HEAD + "G,,d.toml,s.ply,,yd,,\n", "line 2: units = 'yd': mm, cm, m, um, in or nothing"),
    (HEAD + "G,,d.toml,s.ply,,,many,\n", "line 2: cycles_run = 'many': a number from 0 on"),
    (HEAD + "G,,d.toml,s.ply,,,-1,\n", "cycles_run = '-1'"),
    (HEAD + "G,,d.toml,s.ply,,,nan,\n", "cycles_run = 'nan'"),
    (HEAD + "G,,d.toml,s.ply,,,,\n" * 2, "line 3 is the same as line 2: a second scan of the same gear has its own `repeat`"),
    (HEAD + '"G,,d.toml\n', "is no row of a table"),
    ("# a remark\n\ngear_id,design,scans\nG,d,s\nH,d,\"s\nI,d,s\n\nJ,d,s\n", "line 5 is no row of a table"),
])  # fmt: skip
def test_what_is_wrong_is_said_with_its_line(read, text, said):
    with pytest.raises(InputError) as refused:
        read(text)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_no_table_at_all(tmp_path):
    for path, said in ((tmp_path, f"^{tmp_path}: is a folder; a table"), (tmp_path / "no.csv", "no such file")):
        with pytest.raises(InputError, match=said):
            read_manifest(path)
    (tmp_path / "scan.ply").write_bytes(b"ply\xff\xfe\x00")
    (tmp_path / "nul.csv").write_text("gear_id,design,scans\nG,a\0b.toml,s.ply\n")
    for name in ("scan.ply", "nul.csv"):
        with pytest.raises(InputError, match="is not text"):
            read_manifest(tmp_path / name)
