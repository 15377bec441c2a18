"""Count the numeric parameters of the package: numeric names of modules and of classes, tuples by element.

    python .ci/parameters.py [CHECKOUT] [--list PACKAGE]

CHECKOUT is the folder of another version; this one by default.  ``--list`` prints the names of one package.

A parameter is a number, or a tuple of numbers, that a person chose.  Three kinds of numbers are counted in columns of their
own, and are not among the parameters: tables, which are mappings, and collections of collections (coefficients and units of a
standard, vertices of elements, layouts of memory, values of examples); neutral defaults of fields, 0 or 1, of data that
have no such part (a mass of zero, a factor of one); and given numbers, which are annotated as ``Final`` or with a ``Literal``
type. They cannot be tuned: codes, constants of nature, of mathematics or of another program, sizes of a format, seeds.
"""

from __future__ import annotations

import argparse
import ast
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

NAME = "stiffmbs"


class Parameter(NamedTuple):
    """A numeric name, and how many numbers it has."""

    file: Path
    name: str
    column: str
    numbers: int


COLUMNS = ("of modules", "of classes", "of tables", "neutral", "given")


def numbers_in(value: ast.expr | None) -> int:
    """Return how many numbers a value has: 1 for a number or an arithmetic expression of numbers, 0 for anything else."""
    match value:
        case ast.Constant(value=bool()):
            return 0
        case ast.Constant(value=int() | float() | complex()):
            return 1
        case ast.UnaryOp(operand=operand):
            return numbers_in(operand)
        case ast.BinOp(left=left, right=right):
            return int(numbers_in(left) == 1 and numbers_in(right) == 1)
        case ast.Tuple(elts=values) | ast.List(elts=values) | ast.Set(elts=values) | ast.Dict(values=values):
            return sum(numbers_in(one) for one in values)
        case ast.Call(func=ast.Name(id="field"), keywords=keywords):
            return sum(numbers_in(keyword.value) for keyword in keywords if keyword.arg == "default")
    return 0


def parameters(file: Path) -> Iterator[Parameter]:
    """Yield the numeric names of a module and of its classes."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    classes = (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef) and not is_enumeration(node))
    bodies = [("", tree.body), *((node.name, node.body) for node in classes)]
    for owner, body in bodies:
        for statement in body:
            match statement:
                case ast.AnnAssign(target=target, annotation=annotation, value=value) if is_given(annotation):
                    yield from (found._replace(column="given") for found in _of_assignment(file, owner, target, value))
                case ast.Assign(targets=[target], value=value) | ast.AnnAssign(target=target, value=value):
                    yield from _of_assignment(file, owner, target, value)


def _of_assignment(file: Path, owner: str, target: ast.expr, value: ast.expr | None) -> Iterator[Parameter]:
    numbers = numbers_in(value)
    if value is not None and numbers:
        name = ast.unparse(target)
        column = "of tables" if is_table(value) else "neutral" if owner and is_neutral(value) else COLUMNS[bool(owner)]
        yield Parameter(file, f"{owner}.{name}" if owner else name, column, numbers)


def is_enumeration(node: ast.ClassDef) -> bool:
    """Return True for a class of codes, which are no parameters."""
    return any(isinstance(base, ast.Name) and base.id.endswith("Enum") for base in node.bases)


def is_given(annotation: ast.expr) -> bool:
    """Return True if a type states that the value is never changed."""
    return any(isinstance(part, ast.Name) and part.id in ("Final", "Literal") for part in ast.walk(annotation))


def is_table(value: ast.expr) -> bool:
    """Return True for a mapping, and for a collection of collections."""
    nested = ast.Tuple | ast.List | ast.Set | ast.Dict
    return isinstance(value, ast.Dict) or (isinstance(value, nested) and any(isinstance(x, nested) for x in value.elts))


def is_neutral(value: ast.expr) -> bool:
    """Return True for 0 and 1, and for tuples of them."""
    if isinstance(value, ast.Tuple):
        return all(map(is_neutral, value.elts))
    return isinstance(value, ast.Constant) and value.value in (0, 1)


def main() -> None:
    """Print a line for each package, and the total."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkout", nargs="?", type=Path, default=Path(__file__).parents[1])
    parser.add_argument("--list", metavar="PACKAGE", help="print the names of a package")
    asked = parser.parse_args()
    root = asked.checkout.resolve() / NAME
    counts = {column: Counter[str]() for column in COLUMNS}
    for file in sorted(root.glob("**/*.py")):
        place = file.relative_to(root)
        package = place.parts[0] if len(place.parts) > 1 else "(top level)"
        for parameter in parameters(file):
            counts[parameter.column][package] += parameter.numbers
            if asked.list == package:
                numbers = f" ({parameter.numbers})" if parameter.numbers > 1 else ""
                print(f"{place}: {parameter.name}{numbers} {parameter.column}")
    for package in sorted(set().union(*counts.values())):
        print(f"{package:22}", "".join(f"{own[package]:6} {column}" for column, own in counts.items()))
    print(f"{'total':22}", "".join(f"{own.total():6} {column}" for column, own in counts.items()))
    print(f"parameters: {sum(counts[column].total() for column in COLUMNS[:2])}, of modules and of classes")


if __name__ == "__main__":
    main()
