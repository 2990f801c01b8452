"""The rules of the house, read off the syntax tree of each module: who may import what, and what is not written at all."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FREE = {"arrays", "compiled", "errors", "memory", "processors", "robust", "threads"}
"""Modules beside the rooms that everybody may import."""

SHIMS = {"compare", "models", "cli", "__main__", "__init__"}
"""Beside the rooms and the free modules nothing else is there: what the contract calls by name, and the console command."""

BELOW = {
    "design": set(),
    "scan": {"design"},
    "placing": {"design", "scan"},
    "identify": {"design", "placing"},
    "inspection": {"design"},
    "diagnose": {"design", "placing"},
    "wear": {"design", "placing", "diagnose"},
    "meshing": {"design"},
    "loaded": {"design", "meshing"},
    "wear_law": {"design", "placing", "diagnose", "wear", "meshing", "loaded"},
    "running": {"design", "placing", "diagnose", "wear", "meshing", "loaded", "wear_law"},
    "brep": {"design"},
    "paper": {"design", "meshing"},
}
COMPARISON = set(BELOW) - {"brep", "paper", "identify"}
MAY_IMPORT: dict[str, set[str]] = {
    **BELOW,
    "comparison": COMPARISON,
    "report": {*COMPARISON, "comparison"},
    "fleet": {*COMPARISON, "comparison", "report"},
    "commands": {*BELOW, "comparison", "report", "fleet", "api"},
    "api": {*BELOW, "comparison", "report"},
}
"""Rooms by rooms, upwards. The report is imported by the commands, the fleet and `api` alone."""

FRONT = "shim"

ONLY_IN: dict[str, set[str]] = {
    "build123d": {"brep"},
    "OCP": {"brep"},
    "trimesh": {"scan", "report"},
    "plyfile": {"scan"},
    "pye57": {"scan"},
    "laspy": {"scan"},
    "lxml": {"scan"},
    "networkx": {"scan"},
    "manifold3d": {"wear"},
    "matplotlib": {"report"},
    "mpl_toolkits": {"report"},
    "jinja2": {"report"},
    "reportlab": {"report"},
    "pypdf": {"report"},
    "PIL": {"report"},
    "ezdxf": {"report"},
    "distributed": {"fleet"},
    "duckdb": {"fleet"},
    "rich": {"report", "commands"},
    "skfem": {"loaded"},
    "threadpoolctl": {"threads"},
    "numba": {"compiled"},
    "cadquery": set(),
    "open3d": set(),
    "scipy": {*BELOW, "comparison", "report", "fleet"} - {"design"},  # design: numpy only
}
"""Packages by the rooms that may import them."""

LONGEST = 550
MEASURING = {"scan", "placing", "inspection", "diagnose", "wear", "meshing", "loaded", "wear_law", "running", "comparison"}
REPORT_CALLS = {
    "pair_words", "take_up_words", "named_effects", "across_words",  # words
    "nominal_like", "outlines", "on_outline",  # triangles and outlines of profiles, for pictures and solids
    "stations",  # heights of section curves
    "tolerances", "pressure_angle_deviation",  # an inspection's own; to become fields of it
}  # fmt: skip
"""Functions of the measuring rooms that the report may call. All else it takes from there is a type or a constant: it computes nothing."""

MOST_BY_POSITION = 8
"""Fields of a dataclass from which on each is given by its name."""

FORBIDDEN_NAMES = {"mesh", "meshes"}
"""Triangles to one reader and gear contact to the other: `triangles` and `meshing` say which."""


@dataclass(frozen=True, slots=True)
class Import:
    """One imported module.

    Parameters
    ----------
    module : str
        Absolute dotted name.
    line : int
        Where.
    star : bool
        All its names.
    runs : bool
        False under ``if TYPE_CHECKING``: only read by type checkers.
    """

    module: str
    line: int
    star: bool = False
    runs: bool = True


@cache
def parsed(source: str) -> ast.Module:
    """Of a module's text; each is parsed once, whatever is asked of it."""
    return ast.parse(source)


@cache
def nodes(tree: ast.Module) -> tuple[ast.AST, ...]:
    """All of a module's tree, walked once for all rules."""
    return tuple(ast.walk(tree))


def room_of(module: str) -> str:
    """Room of a dotted module of the package; the front doors are one."""
    parts = module.split(".")
    name = parts[1] if len(parts) > 1 else ""
    if parts[-1] == "__main__":
        return FRONT
    return name if name in MAY_IMPORT or name in FREE else FRONT


def last_name(node: ast.expr) -> str:
    """Name, or the last one of dotted ones; empty of anything else. To write the tree out as text would take most of the time."""
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def imports(tree: ast.Module, module: str, package: bool) -> Iterator[Import]:
    """All imports of a module, wherever they stand, relative ones made absolute, and those by name in a string."""
    typing_only = {
        id(inner)
        for node in nodes(tree)
        if isinstance(node, ast.If) and last_name(node.test) == "TYPE_CHECKING"
        for statement in node.body
        for inner in ast.walk(statement)
    }
    for node in nodes(tree):
        runs = id(node) not in typing_only
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield Import(alias.name, node.lineno, runs=runs)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                above = module.split(".")[: len(module.split(".")) - node.level + package]
                base = ".".join([*above, *([base] if base else [])])
            for alias in node.names:
                star = alias.name == "*"
                # `from gearwear import wear` imports a module; `from gearwear.wear import volume` needs no more than its room
                yield Import(base if star else f"{base}.{alias.name}", node.lineno, star, runs)
        elif isinstance(node, ast.Call) and last_name(node.func) in ("import_module", "__import__"):
            first = node.args[0] if node.args else None
            if isinstance(first, ast.Constant) and isinstance(first.value, str):
                yield Import(first.value, node.lineno, runs=runs)


def violations(source: str, module: str, package: bool = False) -> list[str]:
    """What a module does against the rules.

    Parameters
    ----------
    source : str
        Its text.
    module : str
        Its dotted name, such as ``gearwear.wear.volume``.
    package : bool
        Whether it is an ``__init__``.

    Returns
    -------
    list of str
        One line per violation: module, line, what.
    """
    tree = parsed(source)
    room = room_of(module)
    found: list[tuple[int, str]] = []
    if source.count("\n") >= LONGEST:
        found.append((LONGEST, f"{len(source.splitlines())} lines: split it before {LONGEST}"))
    for one in imports(tree, module, package):
        top = one.module.split(".")[0]
        if one.star:
            found.append((one.line, f"imports * from {one.module}"))
        if top == "gearwear":
            other = room_of(one.module)
            inner = other in (room, *FREE) or one.module == "gearwear"
            allowed = inner or room == FRONT or (room in MAY_IMPORT and other in MAY_IMPORT[room])
            if not allowed:
                found.append((one.line, f"{room} imports {one.module} ({other})"))
            parts = one.module.split(".")
            if (
                room == "report"
                and other in MEASURING
                and len(parts) > 3
                and parts[-1][0].islower()
                and parts[-1] not in REPORT_CALLS
            ):
                found.append((one.line, f"report computes nothing: it takes types from {other}, not {parts[-1]}"))
        elif one.runs and top in ONLY_IN and room not in ONLY_IN[top]:
            found.append((one.line, f"{room} imports {top}, which belongs to {', '.join(sorted(ONLY_IN[top])) or 'nobody'}"))
    for node in nodes(tree):
        for name in _names(node):
            if name in FORBIDDEN_NAMES:
                found.append((getattr(node, "lineno", 0), f"the name `{name}`: triangles or meshing?"))
    return [f"{module}:{line} {what}" for line, what in found]


def _names(node: ast.AST) -> Iterator[str]:
    """Names that a node gives to something."""
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
        yield node.id
    elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
        yield node.attr
    elif isinstance(node, ast.arg):
        yield node.arg
    elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield node.name
    elif isinstance(node, ast.alias):
        yield node.asname or node.name.split(".")[-1]


def modules(folder: Path) -> Iterator[tuple[str, bool, str]]:
    """Dotted name, whether it is an ``__init__``, and text of every module under the package's folder."""
    for path in sorted(folder.rglob("*.py")):
        parts = list(path.relative_to(folder.parent).with_suffix("").parts)
        package = parts[-1] == "__init__"
        yield ".".join(parts[:-1] if package else parts), package, path.read_text(encoding="utf-8")


def large_dataclasses(folder: Path) -> set[str]:
    """Names of the dataclasses with more than `MOST_BY_POSITION` fields of their own."""
    found = set()
    for _, _, source in modules(folder):
        for node in nodes(parsed(source)):
            if isinstance(node, ast.ClassDef) and any("dataclass" in ast.unparse(one) for one in node.decorator_list):
                fields = [b for b in node.body if isinstance(b, ast.AnnAssign) and "ClassVar" not in ast.unparse(b.annotation)]
                if len(fields) > MOST_BY_POSITION:
                    found.add(node.name)
    return found


def by_position(source: str, module: str, large: set[str]) -> list[str]:
    """Where a large dataclass is built with more than four fields by position, or with a starred list of them."""
    found = []
    for node in nodes(parsed(source)):
        if isinstance(node, ast.Call) and last_name(node.func) in large:
            starred = any(isinstance(one, ast.Starred) for one in node.args)
            if len(node.args) > 4 or starred:
                found.append(f"{module}: {ast.unparse(node.func)}")
    return found


def arrows(root: Path) -> dict[str, set[str]]:
    """Modules of the package by those that they import, wherever the import stands; what only type checkers read is left out."""
    everything = {name: (package, source) for name, package, source in modules(root)}
    found: dict[str, set[str]] = {}
    for name, (package, source) in everything.items():
        targets = set()
        for one in imports(parsed(source), name, package):
            target = one.module if one.module in everything else one.module.rpartition(".")[0]
            if one.runs and target in everything and target != name and target != "gearwear":
                targets.add(target)
        found[name] = targets
    return found


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """Groups of more than one module that can be reached from one another (Tarjan's strongly connected components)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in graph[node]:
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            at = stack.index(node)
            group, stack[at:] = stack[at:], []
            if len(group) > 1:
                found.append(sorted(group))

    for node in graph:
        if node not in index:
            visit(node)
    return found
