"""The same scan in another pose, its points in another order: every number of the report and every standard deviation is the same.

Which tooth is called the first, and which end is up, follows from how the part lay; what is found on it does not. So numbers are held against each
other path by path through the report, those of all teeth together, in order of size.
"""

from __future__ import annotations

import json
import re
from functools import cache
from typing import Any

import numpy as np
import pytest

from gearwear.api import as_dict
from gearwear.comparison.stations import compare
from gearwear.design import read_design
from gearwear.scan import read_one
from tests.commands.doors import EXAMPLE, PAIR
from tests.commands.test_degenerate import AGAIN, turned
from tests.commands.test_degenerate_kinds import drawn
from tests.scan.writers import ply
from tests.synthetic.helical import Helical, scan
from tests.synthetic.tooth import Patch
from tests.wear.test_breakage_kinds import broken_off

OF_THE_POSE = (
    r"rotation\[|translation|covariance|rotation_std_deg|phase|direction|centroid|_at_|at_z|at_deg|tooth$|after_tooth|"
    r"wear_law\.teeth|(left|right)_out|across_face|lean|sha256|helix\.mean.*slope"
)
"""Keys of what lies in the frame, not on the part; and those that number its teeth."""
ROLL = (5.0, 11.0)
"""Lengths of roll, mm, between which the helical gear is worn."""
MIRRORED = r"index_um|single_um"
"""Keys of what counts round the gear: upside down it goes the other way."""


def broken_helical() -> np.ndarray:
    """Worn, with a corner gone, and with a root that the design does not state."""
    gear = Helical(tip_radius=0.38)
    worn = scan(gear, 40_000, wear=(Patch(4, 1, 0.12, ROLL, (3.0, 10.0)), Patch(9, -1, 0.06, ROLL, (2.0, 12.0))))
    return np.asarray(broken_off(gear, "broken corner").of(worn.points, 0.008))


CASES = {
    "a side worn throughout": (PAIR.read_text(encoding="utf-8"), lambda: read_one(EXAMPLE / "scan.ply.gz").points[::4]),
    "helical and broken": (drawn(Helical(), Helical().width, ""), broken_helical),
}
WORDS = {**AGAIN, "turned": lambda points: np.random.default_rng(5).permutation(turned(points))}


def numbers(report: Any, upside_down: bool, path: str = "") -> dict[str, list[float]]:
    """All numbers by their path through the report, those of a list together."""
    found: dict[str, list[float]] = {}

    def side(word: str) -> str:
        swap = {"left": "right", "right": "left", "low": "high", "high": "low"}
        return re.sub(r"left|right|(?<=end_)low|(?<=end_)high", lambda one: swap[one[0]], word) if upside_down else word

    def take(value: Any, at: str) -> None:
        for key, values in numbers(value, upside_down, at).items():
            found.setdefault(key, []).extend(values)

    if isinstance(report, dict):
        for key, value in report.items():
            take(value, f"{path}.{side(key)}")
    elif isinstance(report, list):
        for value in report:
            labels = (
                [str(value[key]) for key in ("name", "symbol", "flank", "flanks") if key in value]
                if isinstance(value, dict)
                else []
            )
            take(value, f"{path}[{side(' '.join(labels))}]")
    elif isinstance(report, (int, float)) and not re.search(OF_THE_POSE, path):
        found[path] = [abs(float(report)) if re.search(MIRRORED, path) else float(report)]
    return found


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    """The report of a case, its points as they are or in other words; each is made once."""
    folder = tmp_path_factory.mktemp("poses")

    @cache
    def compare_case(case: str, words: str) -> Any:
        design, make = CASES[case]
        (folder / "design.toml").write_text(design)
        (folder / "a.ply").write_bytes(ply(WORDS[words](make()), kind="f8"))
        report = as_dict(compare(read_design(folder / "design.toml"), [folder / "a.ply"]))
        return json.loads(json.dumps(report))

    return compare_case


@pytest.mark.long
@pytest.mark.parametrize("case", CASES)
def test_every_number_is_the_same_in_another_pose(compared, case):
    reports = compared(case, "as it is"), compared(case, "turned")
    pose = [np.array(report["registration"]["rotation"]) for report in reports]
    upside_down = bool((pose[1] @ turned(np.eye(3)).T - pose[1] @ turned(np.zeros((1, 3))).T)[2] @ pose[0][2] < 0.0)
    here, there = numbers(reports[0], False), numbers(reports[1], upside_down)
    assert set(here) == set(there) and len(here) > 200
    for path, values in here.items():
        # Rounded to 0.01 in an inspection; elsewhere a nanometre.
        least = 0.021 if path.startswith(".inspection") else 1e-6 if path.endswith("_mm") else 1e-3
        assert sorted(there[path]) == pytest.approx(sorted(values), rel=1e-3, abs=least), path


def stds(report: Any) -> dict[str, float]:
    """Standard deviations by key."""
    worn, (coat, table) = report["meshing"]["worn"], report["closed_loop"]["effects"]
    return {
        "noise": report["closed_loop"]["noise_um"],
        "volume": report["wear"]["volume_mm3"]["std"],
        "volume without the loop": report["wear"]["before_loop"]["volume_mm3"]["std"],
        "rotation": report["registration"]["rotation_std_at_base_circle_um"],
        "coat": coat["parameters"]["thickness_um"]["std"],
        "table": table["parameters"]["amplitude_deg"]["std"],
        "thickness": float(np.mean([tooth["std_mm"] for tooth in report["thickness"]])),
        "deepest wear": max(report["wear"]["regions"], key=lambda region: region["max_depth_um"])["max_depth_std_um"],
        "least of a tooth": float(np.mean([tooth["min_std_mm"] for tooth in report["thickness"]])),
        "transmission error": worn["transmission_error_um_std"],
        "backlash": worn["backlash"]["circumferential_mm_std"],
        "least backlash": worn["backlash"]["circumferential_mm_min_std"],
    }


@pytest.mark.long
def test_coarser_numbers_are_known_less_well(compared):
    """Nothing is known better.

    The ± of the pose is made of what the gear's sides differ by, 2 µm here: noise widens the window in which their cells count in full, so what is
    left of it is a little less. Else one that is found from what is left over scatters itself, by a hundredth.
    """
    fine, coarse = (stds(compared(next(iter(CASES)), words)) for words in ("as it is", "to 50 µm"))
    for key, value in fine.items():
        assert coarse[key] > (0.95 if key == "rotation" else 0.99) * value, key
