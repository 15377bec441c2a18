"""Count the numeric parameters of the package: numeric names of modules and of classes, tuples by element.

    python .ci/parameters.py [CHECKOUT] [--list PACKAGE]

CHECKOUT is the folder of another version; this one by default.  ``--list`` prints the names of one package.
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
    in_class: bool
    numbers: int


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
    bodies = [("", tree.body), *((node.name, node.body) for node in ast.walk(tree) if isinstance(node, ast.ClassDef))]
    for owner, body in bodies:
        for statement in body:
            match statement:
                case ast.Assign(targets=[target], value=value) | ast.AnnAssign(target=target, value=value):
                    yield from _of_assignment(file, owner, target, value)


def _of_assignment(file: Path, owner: str, target: ast.expr, value: ast.expr | None) -> Iterator[Parameter]:
    numbers = numbers_in(value)
    if numbers:
        name = ast.unparse(target)
        yield Parameter(file, f"{owner}.{name}" if owner else name, bool(owner), numbers)


def main() -> None:
    """Print a line for each package, and the total."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkout", nargs="?", type=Path, default=Path(__file__).parents[1])
    parser.add_argument("--list", metavar="PACKAGE", help="print the names of a package")
    asked = parser.parse_args()
    root = asked.checkout.resolve() / NAME
    of_modules: Counter[str] = Counter()
    of_classes: Counter[str] = Counter()
    for file in sorted(root.glob("**/*.py")):
        place = file.relative_to(root)
        package = place.parts[0] if len(place.parts) > 1 else "(top level)"
        for parameter in parameters(file):
            (of_classes if parameter.in_class else of_modules)[package] += parameter.numbers
            if asked.list == package:
                print(f"{place}: {parameter.name}" + (f" ({parameter.numbers})" if parameter.numbers > 1 else ""))
    for package in sorted({*of_modules, *of_classes}):
        print(f"{package:16} {of_modules[package]:5} of modules {of_classes[package]:5} of classes")
    print(f"{'total':16} {of_modules.total():5} of modules {of_classes.total():5} of classes")


if __name__ == "__main__":
    main()
