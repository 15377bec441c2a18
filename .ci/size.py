"""Print files and lines of each package, imports that point upward, and cycles of imports.

    python .ci/size.py [CHECKOUT]

CHECKOUT is the folder of another version, as `git worktree add` makes one; this one by default.  Imports within functions
count; those for type checkers alone do not.  An import points upward if its package comes after that of the importing file
in the order of tests/test_packages.py.
"""

from __future__ import annotations

import ast
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

NAME = "stiffmbs"
Module = tuple[str, ...]


def modules(root: Path) -> dict[Module, Path]:
    """Return the modules of the package and their files."""
    return {(NAME, *path.relative_to(root).with_suffix("").parts): path for path in sorted(root.glob("**/*.py"))}


def imports(module: Module, known: dict[Module, Path]) -> set[Module]:
    """Return the modules of the package that a module imports, within functions too."""
    found = set()
    for node in _statements(ast.parse(known[module].read_text(encoding="utf-8"))):
        if not isinstance(node, ast.ImportFrom):
            continue
        base = module[: len(module) - node.level] if node.level else ()
        base = (*base, *(node.module or "").split(".")) if node.module else base
        for alias in node.names:
            candidates = ((*base, alias.name), (*base, alias.name, "__init__"), base, (*base, "__init__"))
            found.update([next((name for name in candidates if name in known), ())])
    return found - {()}


def _statements(tree: ast.AST) -> Iterator[ast.AST]:
    for node in ast.iter_child_nodes(tree):
        if not (isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)):
            yield node
            yield from _statements(node)


def cycles(graph: dict[Module, set[Module]]) -> list[set[Module]]:
    """Return the strongly connected components of more than one module, the largest first (Tarjan 1972)."""
    order: dict[Module, int] = {}
    low: dict[Module, int] = {}
    stack: list[Module] = []
    found: list[set[Module]] = []

    def visit(module: Module) -> None:
        order[module] = low[module] = len(order)
        stack.append(module)
        for other in graph[module]:
            if other not in order:
                visit(other)
                low[module] = min(low[module], low[other])
            elif other in stack:
                low[module] = min(low[module], order[other])
        if low[module] == order[module]:
            place = stack.index(module)
            found.append(set(stack[place:]))
            del stack[place:]

    sys.setrecursionlimit(10_000)
    for module in graph:
        if module not in order:
            visit(module)
    return sorted((part for part in found if len(part) > 1), key=len, reverse=True)


def order_of_packages(checkout: Path) -> tuple[str, ...]:
    """Return the packages in their order, from the test that keeps it."""
    tree = ast.parse((checkout / "tests" / "test_packages.py").read_text(encoding="utf-8"))
    values = {
        target.id: node.value
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    return tuple(ast.literal_eval(values["ORDER"]))


def main() -> None:
    """Print the tables."""
    checkout = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[1]).resolve()
    known = modules(checkout / NAME)
    order = order_of_packages(checkout)
    lines: Counter[str] = Counter()
    files: Counter[str] = Counter()
    for module, path in known.items():
        package = module[1] if len(module) > 2 else "(top level)"
        files[package] += 1
        lines[package] += len(path.read_text(encoding="utf-8").splitlines())
    total = sum(lines.values())
    for package, count in lines.most_common():
        print(f"{package:16} {files[package]:5} files {count:7} lines {100 * count / total:5.1f} %")
    print(f"{'total':16} {sum(files.values()):5} files {total:7} lines")
    graph = {module: imports(module, known) for module in known}
    upward = sorted(
        (module, other)
        for module, others in graph.items()
        for other in others
        if module[1] in order and other[1] in order and order.index(other[1]) > order.index(module[1])
    )
    print(f"imports that point upward: {len(upward)}, in {len({module for module, _ in upward})} files")
    for module, other in upward:
        print(f"  {'.'.join(module)} -> {'.'.join(other)}")
    parts = cycles(graph)
    print(f"cycles of imports: {', '.join(f'{len(part)} files' for part in parts) or 'none'}")


if __name__ == "__main__":
    main()
