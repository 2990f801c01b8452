"""What an inspection writes, read by another program: DuckDB finds names, types and numbers of the CSV files by itself."""

from __future__ import annotations

import duckdb
import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.inspection import Settings, inspect
from gearwear.report.files.inspection import write_columns
from gearwear.report.files.inspection_columns import finding_columns, flank_columns, trace_columns
from tests.inspection.synthetic import displaced, flanks

GEAR = Gear.from_spec(GearSpec("gear", 12, 3.0, 12.0))


@pytest.fixture(scope="module")
def found():
    points = flanks(GEAR, 60, 12)
    rng = np.random.default_rng(3)
    slope = (
        np.linspace(-0.02, 0.02, GEAR.teeth)[points.tooth]
        * (points.roll - GEAR.reference_roll)
        / (GEAR.tip_roll - GEAR.form_roll)
    )
    off = slope + rng.normal(0.0, 2e-4, len(points))
    return inspect(displaced(points, off, GEAR), GEAR, Settings(noise=2e-4, laboratory=True))


@pytest.mark.parametrize("columns", [finding_columns, flank_columns, trace_columns], ids=lambda f: f.__name__)
def test_duckdb_reads_the_tables_as_they_were(found, columns, tmp_path):
    table = columns(found)
    write_columns(tmp_path / "table.csv", table)
    read = duckdb.read_csv(str(tmp_path / "table.csv")).fetchnumpy()
    assert list(read) == list(table)
    for name, values in table.items():
        got = read[name]
        if isinstance(got, np.ma.MaskedArray) and got.dtype.kind in "fi":  # what is empty in the file
            got = got.astype(float).filled(np.nan)
        if np.asarray(values).dtype.kind == "f" and np.isfinite(values.astype(float)).any():
            np.testing.assert_allclose(np.asarray(got, dtype=float), values.astype(float), rtol=1e-4, atol=1e-3, equal_nan=True)


def test_duckdb_finds_the_slope_in_the_trace(found, tmp_path):
    """A line through the evaluated points of a mean profile, fitted by the other program's own regression."""
    write_columns(tmp_path / "traces.csv", trace_columns(found))
    query = f"""select tooth, regr_slope(deviation_um, roll_mm) * {found.profile.range.length} as slope
        from read_csv('{tmp_path / "traces.csv"}')
        where kind = 'profile' and place = 'mean' and flank = 'left' and evaluated = 1 group by tooth order by tooth"""
    slope = duckdb.sql(query).fetchnumpy()["slope"]
    np.testing.assert_allclose(slope, 1e3 * found.profile.slope.value[:, 0], atol=0.15)
