"""Check the language of docstrings and comments of the package: openings, forbidden words, long sentences.

    python .ci/language.py [FOLDER or FILE]...

Exit status: 0 no finding, 1 findings, each printed with its place.  The rules are those of SciPy and of SUNDIALS: the first
line of a docstring begins with a verb or a noun of the field; the field's term is used for each thing; sentences are short.
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
OPENINGS = ("What", "Whether", "Those", "That", "How", "Where", "The same")
"""First words of docstrings that name no action and no thing."""
INSTEAD = {
    "anew": "again, restart",
    "told": "reported, noted",
    "beside": "next to, compared with",
    "behind": "after",
    "taken again": "rerun",
    "seen through": "validate",
    "at a glance": "scan",
    "at hand": "current, available",
    "creep": "constraint drift",
    "inverse_mass": "inverse mass",
    "dearer": "more expensive",
    "straight coordinates": "coordinates whose rate is a velocity",
    "stepped over": "missed event",
}
"""Words that other authors of this field do not use, and theirs."""
LONGEST = 28
"""Words of a sentence."""
OWNERS = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def docstrings(tree: ast.AST) -> Iterator[tuple[int, str, bool]]:
    """Yield line, text, and whether it is of a module, class or function (else of an attribute)."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if not isinstance(body, list):
            continue
        for place, statement in enumerate(body):
            match statement:
                case ast.Expr(value=ast.Constant(value=str() as text)):
                    yield statement.lineno, text, place == 0 and isinstance(node, OWNERS)


def comments(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and text of each comment for people, those for tools left out."""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT and not re.match(r"#\s*(fmt|noqa|type|ruff|mutation|pragma):", token.string):
            yield token.start[0], token.string.lstrip("# ")


def sentences(text: str) -> Iterator[str]:
    """Yield the sentences of the paragraphs of a docstring; lists, tables, sections and examples are left out."""
    for paragraph in re.split(r"\n\s*\n", text):
        lines = paragraph.strip().splitlines()
        if any(re.match(r"\s*([-*|]|>>>|\.\.|-{3,}|\d\.)", line) or ":: " in line for line in lines):
            continue
        joined = re.sub(r"``[^`]*``|`[^`]*`", "x", " ".join(line.strip() for line in lines))
        yield from re.split(r"(?<=[.;:!?])\s+", joined)


def findings(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and message of each fault."""
    texts = []
    for line, text, named in docstrings(ast.parse(source)):
        texts.append((line, text))
        first = text.strip().split("\n")[0]
        for opening in OPENINGS:
            if named and re.match(rf"{opening}\b", first):
                yield line, f"the docstring begins with '{opening}'"
        for sentence in sentences(text):
            if len(sentence.split()) > LONGEST and "=" not in sentence:  # the parts of a formula are no words
                yield line, f"{len(sentence.split())} words in one sentence: {sentence[:60]}..."
    for line, text in [*texts, *comments(source)]:
        text = re.sub(
            r"``[^`]*``|`[^`]*`|^\s*[\w, ]+ : .*$", "", text, flags=re.MULTILINE
        )  # names of things in the code
        for word, instead in INSTEAD.items():
            if re.search(rf"\b{word}\b", text, re.IGNORECASE):
                yield line, f"'{word}', expected {instead}"


def main(arguments: list[str]) -> int:
    """Print the findings; return the exit status."""
    found = 0
    for place in map(Path, arguments or [str(ROOT / "stiffmbs")]):
        for path in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
            for line, message in findings(path.read_text(encoding="utf-8")):
                found += 1
                print(f"{path}:{line}: {message}")
    print(f"{found} findings")
    return int(found > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
