"""A streamed scan gives what the scan in memory gives."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from gearwear.comparison.pass_limits import PassLimits
from gearwear.comparison.results import Results
from gearwear.comparison.stations import compare
from gearwear.design.files.toml import read_design
from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import flank_points
from gearwear.errors import InputError
from gearwear.placing.cells import CellGrid
from gearwear.report.files.extras import write_parquet
from gearwear.scan import pieces, read_one, streaming
from tests.commands.doors import EXAMPLE, ONE, run, thinner_example
from tests.scan.writers import ply

pytestmark = pytest.mark.long

GEAR = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
SHARE = 0.1
"""Of the stated standard deviation, by which a streamed scan may differ."""
SAMPLE, PIECE = 12_000, 5_000


@dataclass(frozen=True)
class Both:
    whole: Results
    streamed: Results


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Both]:
    """The bundled scan, every fifth point, with its strays; under a coat, on a table whose angle is off."""
    folder = tmp_path_factory.mktemp("streamed")
    design = folder / "one.toml"
    design.write_text(ONE)
    scan = thinner_example(folder, 5)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(streaming, "SAMPLE", SAMPLE)
        patch.setattr(pieces, "PIECE", PIECE)
        whole, streamed = (compare(read_design(design), [scan], inspection=False, stream=stream) for stream in (False, True))
        assert whole.measured.streamed is None and streamed.measured.streamed is not None
        yield Both(whole, streamed)


def test_the_volume_is_the_same(both: Both) -> None:
    whole, streamed = both.whole.wear, both.streamed.wear

    assert abs(streamed.volume - whole.volume) < SHARE * whole.volume_std
    assert streamed.volume_std == pytest.approx(whole.volume_std, rel=SHARE)
    assert {(one.tooth, one.side) for one in streamed.found.regions} == {(one.tooth, one.side) for one in whole.found.regions}


def test_the_effects_are_the_same(both: Both) -> None:
    whole, streamed = both.whole.loop, both.streamed.loop
    assert whole is not None and streamed is not None

    assert [one.name for one in streamed.effects] == [one.name for one in whole.effects] != []
    for one, other in zip(streamed.effects, whole.effects, strict=True):
        for name, estimate in other.parameters.items():
            assert abs(one.parameters[name].value - estimate.value) <= SHARE * estimate.std, name


def test_the_thickness_is_the_same(both: Both) -> None:
    whole, streamed = both.whole.wear.thickness, both.streamed.wear.thickness

    off = np.abs(streamed.arc - whole.arc) / whole.std
    same = (streamed.count == whole.count).all(axis=1)
    assert same.mean() > 0.99  # here and there a point at the limit is a stray for one and none for the other
    assert np.nanmax(off[same]) < SHARE
    for one, other in zip(streamed.teeth(), whole.teeth(), strict=True):
        assert abs(one.least - other.least) < SHARE * other.std and abs(one.mean - other.mean) < SHARE * other.std


def test_every_point_is_counted(both: Both) -> None:
    whole, streamed = both.whole.measured, both.streamed.measured

    assert streamed.points == whole.points
    assert streamed.used + streamed.other + sum(streamed.rejected.values()) == streamed.points
    assert abs(streamed.used - whole.used) < 1e-4 * whole.used
    assert len(streamed.located) < len(whole.located) / 2


def test_the_pose_is_that_of_all_points(both: Both) -> None:
    """A sample of two fifths knows its pose 1.6 times worse; moved by the cells of all points it lies where that of all points lies."""
    whole, streamed = (one.measured.placed.registration for one in (both.whole, both.streamed))

    std = np.sqrt(np.diag(whole.covariance))
    away = streamed.pose.then(whole.pose.inverse())
    assert np.all(np.abs(away.translation) < 0.3 * std[:3] + 1e-4)
    assert away.angle < 0.3 * float(np.linalg.norm(std[3:]))


def test_every_point_is_written_chunk_by_chunk(both: Both, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    tables = []
    for name, results in (("whole", both.whole), ("streamed", both.streamed)):
        (tmp_path / name).mkdir()
        write_parquet(results, tmp_path / name)
        tables.append(parquet.read_table(tmp_path / name / "points.parquet").to_pydict())
    whole, streamed = ({key: np.array(values) for key, values in table.items()} for table in tables)

    assert len(streamed["x_mm"]) == both.whole.measured.points
    for axis in ("x_mm", "y_mm", "z_mm"):  # as far as the two poses lie apart
        np.testing.assert_allclose(streamed[axis], whole[axis], rtol=0, atol=1e-3)
    same = (streamed["surface"] == whole["surface"]) & (streamed["tooth"] == whole["tooth"]) & (whole["surface"] != "other")
    assert same.mean() > 0.999
    off = np.abs(streamed["corrected_um"][same].astype(float) - whole["corrected_um"][same].astype(float))
    assert np.quantile(off, 0.999) < 0.1


@pytest.mark.parametrize("thin", [1, 2, 4])
def test_a_thin_sample_takes_no_edge_of_wear_for_strays(thin: int) -> None:
    """Beside a groove half a millimetre deep every second cell is steep; strays stand 0.4 mm above."""
    rng = np.random.default_rng(4)
    count = 40_000
    tooth, side = rng.integers(0, GEAR.teeth, count), rng.choice([-1, 1], count)
    roll, z = rng.uniform(GEAR.form_roll, GEAR.tip_roll, count), rng.uniform(0.0, GEAR.face_width, count)
    deviation = 0.01 * rng.standard_normal(count) - 0.5 * np.exp(-((z - 7.0) ** 2))
    stray = (rng.random(count) < 0.003) & (np.abs(z - 7.0) > 6.0)  # beyond the cells round the groove
    points = flank_points(GEAR, tooth, side, roll, z).with_deviation(deviation + 0.4 * stray)
    grid = CellGrid.for_scan(GEAR, count)

    by = PassLimits.of_sample(points.take(np.arange(0, count, thin)), grid, 0.06)

    held = by.limits.hold(points.deviation, by.grid.index(points))
    assert (by.grid is grid) == (thin == 1)
    assert not held[stray].any()
    assert held[~stray].mean() > 0.999


@pytest.mark.parametrize(
    ("datum", "said"),
    [('ignore_teeth = [1]\n', "ignore"), ('artefact = [{kind = "sphere", diameter_mm = 10.0, centre_mm = [50.0, 0.0, 0.0]}]\n', "artefact")],
)  # fmt: skip
def test_what_is_not_offered_is_said_by_name(tmp_path: Path, datum: str, said: str) -> None:
    design = tmp_path / "one.toml"
    design.write_text(ONE + "[datum]\n" + datum)
    scan = tmp_path / "few.ply"
    scan.write_bytes(ply(read_one(EXAMPLE / "scan.ply.gz").points[::30]))

    with pytest.raises(InputError, match=rf"\[datum\] {said}.*not offered for a streamed scan"):
        compare(read_design(design), [scan], stream=True)


@pytest.mark.parametrize(
    ("scans", "options", "said"),
    [(1, ["--write", "npz"], "--write npz is not offered for a streamed scan"), (2, [], "2 views of one gear are not streamed")],
)  # fmt: skip
def test_the_command_refuses_before_the_work(tmp_path: Path, scans: int, options: list[str], said: str) -> None:
    design, scan, out = tmp_path / "one.toml", tmp_path / "few.ply", tmp_path / "out"
    design.write_text(ONE)
    scan.write_bytes(ply(read_one(EXAMPLE / "scan.ply.gz").points[::30]))

    refused = run("compare", design, *[scan] * scans, "--stream", *options, "--out", out)

    assert refused.status == 2 and said in refused.err and refused.err.count("\n") == 1
    assert not out.exists()
