"""Everything about an effect stands in its own file: no other file keeps a table of effects' or of parameters' names.

A name of an effect may also be a key of a drawing or a dimension (`tip_diameter`, `face_width`): rooms that cannot know of effects are not
looked at, and in the others a literal is a table of names where two or more, and most, of its strings are.
"""

import ast
from pathlib import Path

import gearwear
from gearwear.diagnose.effects import catalogue
from tests.layers import MAY_IMPORT, modules, nodes, parsed, room_of

NAMES = {effect.name for effect in catalogue()}
PARAMETERS = {parameter.name for effect in catalogue() for parameter in effect.parameters}
OWN = ("gearwear.diagnose.effects", "gearwear.running.effects")
"""Each effect in its own file, those of running too."""
KEYS_OF_WAVES = "gearwear.report.records.laboratory"
"""The waves of a spectrum have an order, an amplitude and a phase as a turntable's error has; they are no effect."""


def strings(node: ast.AST) -> list[str]:
    """Strings that stand directly in a dict (its keys, or its values), set, tuple, list, or in a call of one; a `match` of them too."""
    if isinstance(node, ast.Dict):
        found = [*node.keys, *node.values]
    elif isinstance(node, ast.Set | ast.Tuple | ast.List):
        found = [*node.elts]
    elif isinstance(node, ast.Match):
        found = [inner for case in node.cases for inner in ast.walk(case.pattern)]
    else:
        return []
    return [one.value for one in found if isinstance(one, ast.Constant) and isinstance(one.value, str)]


def tables(source: str) -> list[tuple[int, set[str]]]:
    """Line and names of every table of names."""
    found = []
    for node in nodes(parsed(source)):
        own = {text for text in strings(node) if text.isidentifier()}
        for known in (NAMES, PARAMETERS):
            if len(own & known) >= 2 and 2 * len(own & known) > len(own):
                found.append((node.lineno, own & known))
    return found


def test_no_other_file_keeps_a_table_of_names():
    folder = Path(gearwear.__file__).parent
    looked_at, found = 0, []
    for name, _, source in modules(folder):
        room = room_of(name)
        knows = room == "diagnose" or "diagnose" in MAY_IMPORT.get(room, {"diagnose"})
        if knows and not name.startswith(OWN) and name != KEYS_OF_WAVES:
            looked_at += 1
            found += [f"{name}:{line} {sorted(names)}" for line, names in tables(source)]
    assert looked_at > 50
    assert found == []


def test_the_tables_that_once_were_would_be_seen():
    assert tables('SHAPES = frozenset({"order", "phase_deg", "direction_deg", "start_deg", "start_mm"})')
    assert tables('PLAIN = {"burr": "a burr {height_um} high", "twist": "flanks twisted by {twist_um}"}')
    assert tables('zip(("sliding_wear", "abrasive_wear"), amounts)')
    assert tables('match name:\n    case "taper" | "twist":\n        pass')
    assert not tables('columns = {"slope_um": a, "form_um": b, "total_um": c, "crowning_um": d}')
    assert not tables('sizes = ("tip_diameter", "root_diameter", "over_pins")')
