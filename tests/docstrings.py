"""What numpydoc docstrings say of parameters, against the signatures."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from tests.layers import parsed

Documented = list[tuple[str, str]]
"""Names of parameters and their types, "" where none is given."""


def documented(text: str) -> Documented:
    """Of the section `Parameters` of a docstring; empty without one."""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=\n\n|\Z)", text, flags=re.M | re.S)
    heads = [line.partition(" : ") for line in section[1].split("\n") if line[:1].strip()] if section else []
    return [(name.strip().lstrip("*"), kind) for names, _, kind in heads for name in names.split(",")]


def arguments(node: ast.FunctionDef, bound: bool) -> dict[str, ast.expr | None]:
    """Arguments of a function by their annotations, without that which a method is bound to."""
    given = node.args
    plain = [*given.posonlyargs, *given.args][bound:]
    starred = ([given.vararg] if given.vararg else []), ([given.kwarg] if given.kwarg else [])
    return {one.arg: one.annotation for one in (*plain, *starred[0], *given.kwonlyargs, *starred[1])}


def fields(node: ast.ClassDef) -> dict[str, ast.expr | None]:
    """What a class is built of: arguments of its ``__init__``, or the fields of a dataclass."""
    for one in node.body:
        if isinstance(one, ast.FunctionDef) and one.name == "__init__":
            return arguments(one, bound=True)
    stated = (one for one in node.body if isinstance(one, ast.AnnAssign) and "ClassVar" not in ast.unparse(one.annotation))
    return {one.target.id: one.annotation for one in stated if isinstance(one.target, ast.Name)}


def signatures(tree: ast.Module | ast.ClassDef) -> Iterator[tuple[ast.FunctionDef | ast.ClassDef, dict[str, ast.expr | None]]]:
    """Functions, classes and their methods, with what each takes."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            static = "staticmethod" in map(ast.unparse, node.decorator_list)
            yield node, arguments(node, isinstance(tree, ast.ClassDef) and not static)
        elif isinstance(node, ast.ClassDef):
            yield node, fields(node)
            yield from signatures(node)


def holds_none(annotation: ast.expr) -> bool:
    """Whether None may stand in it, or in one of its items; what a function returns is not said."""
    if isinstance(annotation, ast.Subscript) and ast.unparse(annotation.value) == "Callable":
        return False
    inner = (one for one in ast.iter_child_nodes(annotation) if isinstance(one, ast.expr))
    return (isinstance(annotation, ast.Constant) and annotation.value is None) or any(map(holds_none, inner))


def untrue(source: str, module: str) -> list[str]:
    """What docstrings of a module say of parameters that the signatures do not.

    A function's stand in its order. A class of many fields may say together what belongs together: all are there.
    """
    found = []
    for node, taken in signatures(parsed(source)):
        said = documented(ast.get_docstring(node) or "")
        names, wanted = [name for name, _ in said], list(taken)
        if isinstance(node, ast.ClassDef):
            names, wanted = sorted(names), sorted(wanted)
        if said and names != wanted:
            found.append(f"{module}:{node.lineno} {node.name}: {', '.join(names)}; it takes {', '.join(wanted)}")
        for name, kind in said:
            annotation = taken.get(name)
            if kind and annotation and ("None" in kind) is not holds_none(annotation):
                found.append(f"{module}:{node.lineno} {node.name}: {name} : {kind}; it is {ast.unparse(annotation)}")
    return found
