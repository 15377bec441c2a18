"""Builder of the LLVM instructions of one function."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeAlias

from .values import DUAL_KINDS, ITEMS, LLVM_TYPES, NUMBERS, Dual, Operand, Untranslatable, Value, dual

if TYPE_CHECKING:
    from .unit import Unit

PART_KINDS = {kind: part for part, kind in DUAL_KINDS.items()}
"""Kinds of both parts by the kind of dual values."""
Lines: TypeAlias = "list[str | Lines]"
"""Instructions, and lists of instructions that are filled later."""


class Code:
    """Instructions, variables and labels of a function.

    `unit`: module of the function: provides called functions and takes declarations. `reached`: true if the next
    instruction is reachable; otherwise nothing may be written. `forward`: true if its arrays have dual numbers
    (`stiffmbs.compile.machine.translate.unit.Unit`).
    """

    def __init__(self, unit: Unit, forward: bool = False) -> None:
        self.unit = unit
        self.forward = forward
        self.reached = True
        self._entry: Lines = []
        self._lines: Lines = []
        self._count = 0
        self._targets: set[str] = set()
        self._kept: dict[str, Value] = {}

    def lines(self) -> Iterator[str]:
        """Yield all instructions."""
        yield from _flat(self._entry)
        yield from _flat(self._lines)

    def name(self, stem: str = "v") -> str:
        """Return an unused name."""
        self._count += 1
        return f"{stem}{self._count}"

    def put(self, instruction: str) -> None:
        """Write an instruction without a result."""
        self._lines.append(instruction)

    def put_value(self, kind: str, instruction: str) -> Value:
        """Write an instruction and name its result."""
        value = Value(kind, f"%{self.name()}")
        self._lines.append(f"{value.text} = {instruction}")
        return value

    def packed(self, value: Value) -> Value:
        """Return a value as one operand: a dual value as a structure."""
        if not isinstance(value, Dual):
            return value
        first = self.put_value(value.kind, f"insertvalue {LLVM_TYPES[value.kind]} poison, {value.value.typed}, 0")
        return self.put_value(value.kind, f"insertvalue {first.typed}, {value.slope.typed}, 1")

    def unpacked(self, value: Value) -> Value:
        """Return the value of an operand that `packed` has made."""
        if value.kind not in PART_KINDS:
            return value
        parts = (self.put_value(PART_KINDS[value.kind], f"extractvalue {value.typed}, {k}") for k in (0, 1))
        return dual(*parts)

    def gap(self) -> Lines:
        """Return a place for instructions written later with `within`."""
        gap: Lines = []
        self._lines.append(gap)
        return gap

    @contextmanager
    def within(self, gap: Lines) -> Iterator[None]:
        """Write into a gap."""
        lines, self._lines = self._lines, gap
        yield
        self._lines = lines

    def branch(self, target: str) -> None:
        """Branch to a label; only a label may follow."""
        self.put(f"br label %{target}")
        self._targets.add(target)
        self.reached = False

    def choose(self, condition: Value, then: str, otherwise: str) -> None:
        """Branch to one of two labels."""
        self.put(f"br {condition.typed}, label %{then}, label %{otherwise}")
        self._targets |= {then, otherwise}
        self.reached = False

    def label(self, name: str) -> None:
        """Start a block; without branches to its label it is unreachable."""
        if self.reached:
            self.branch(name)
        self.reached = name in self._targets
        if self.reached:
            self.put(f"{name}:")

    def leave(self, instruction: str) -> None:
        """Write an instruction that ends the function."""
        self.put(instruction)
        self.reached = False

    def variable(self, kind: str) -> Value:
        """Allocate a variable; LLVM promotes it to registers."""
        if kind in PART_KINDS:
            return dual(self.variable(PART_KINDS[kind]), self.variable(PART_KINDS[kind]))
        name = f"%{self.name('at')}"
        self._entry.append(f"{name} = alloca {LLVM_TYPES[kind]}")
        return Value(kind, name)

    def array(self, count: int) -> Value:
        """Allocate numbers for the duration of the function; dual numbers if it is differentiated."""
        numbers = self.doubles(count)
        return dual(numbers, self.doubles(count)) if self.forward else numbers

    def doubles(self, count: int) -> Value:
        """Allocate doubles for the duration of the function."""
        name = f"%{self.name('array')}"
        self._entry.append(f"{name} = alloca [{count} x double]")
        return Value("floats", name)

    def kept(self, name: str, count: int) -> Value:
        """Allocate doubles shared by all instructions with this name; the first is NaN initially."""
        if name not in self._kept:
            self._kept[name] = self.doubles(count)
            self._entry.append(f"store double 0x7FF8000000000000, ptr {self._kept[name].text}")
        return self._kept[name]

    def load(self, variable: Value) -> Value:
        """Load a variable."""
        if isinstance(variable, Dual):
            return dual(self.load(variable.value), self.load(variable.slope))
        tag = tag_of(variable.kind)
        return self.put_value(variable.kind, f"load {LLVM_TYPES[variable.kind]}, ptr {variable.text}{tag}")

    def store(self, variable: Value, value: Value) -> None:
        """Store a variable."""
        given = self.converted(value, variable.kind)
        if isinstance(variable, Dual) and isinstance(given, Dual):
            self.store(variable.value, given.value)
            self.store(variable.slope, given.slope)
            return
        self.put(f"store {given.typed}, ptr {variable.text}{tag_of(variable.kind)}")

    def item(self, pointer: Operand, index: Operand) -> Value:
        """Return kind and address of an item."""
        if not isinstance(pointer, Value) or pointer.kind not in ITEMS:
            raise Untranslatable("a subscript of what is no pointer")
        kind = ITEMS[pointer.kind]
        place = self.integer(index)
        if isinstance(pointer, Dual):
            return Dual(kind, "", self.item(pointer.value, place), self.item(pointer.slope, place))
        return Value(
            kind, self.put_value("int", f"getelementptr {LLVM_TYPES[kind]}, {pointer.typed}, {place.typed}").text
        )

    def integer(self, value: Operand) -> Value:
        """Return an integer; a float is refused, as in Python indices."""
        if not isinstance(value, Value) or value.kind not in ("int", "int32", "bool"):
            raise Untranslatable(f"found {value}, expected an integer")
        return self.converted(value, "int")

    def converted(self, value: Operand, kind: str) -> Value:
        """Convert a value to another kind of at least its range; an int to int32 is truncated."""
        if not isinstance(value, Value):
            raise Untranslatable(f"found {value}, expected a {kind}")
        match value.kind, kind:
            case given, wanted if given == wanted:
                return value
            case "bool" | "int" | "int32" | "float", "dual":
                return dual(self.converted(value, "float"), constant(0.0))
            case "quad", "dual quad":
                return dual(value, Value("quad", "zeroinitializer"))
            case "int", "float" if value.text.lstrip("-").isdigit():
                return constant(float(value.text))
            case "bool", "float":
                return self.put_value(kind, f"uitofp {value.typed} to double")
            case "int" | "int32", "float":
                return self.put_value(kind, f"sitofp {value.typed} to double")
            case "bool", "int":
                return self.put_value(kind, f"zext {value.typed} to i64")
            case "int32", "int":
                return self.put_value(kind, f"sext {value.typed} to i64")
            case "int", "int32":
                return self.put_value(kind, f"trunc {value.typed} to i32")
        raise Untranslatable(f"found a value of kind {value.kind}, expected {kind}")

    def truth(self, value: Operand) -> Value:
        """Return True if a number is not zero."""
        if isinstance(value, Dual):
            return self.truth(value.value)
        if isinstance(value, Value) and value.kind == "float":
            return self.put_value("bool", f"fcmp une {value.typed}, 0.0")
        if isinstance(value, Value) and value.kind == "bool":
            return value
        return self.put_value("bool", f"icmp ne {self.integer(value).typed}, 0")


def tag_of(kind: str) -> str:
    """Return the TBAA tag (type-based alias analysis): stores of other kinds do not change the memory."""
    return f", !tbaa !{NUMBERS.index(kind)}" if kind in NUMBERS else ""


def tags() -> list[str]:
    """Return the definitions of all tags, for the end of a module."""
    root = 2 * len(NUMBERS)
    accesses = [f"!{k} = !{{!{len(NUMBERS) + k}, !{len(NUMBERS) + k}, i64 0}}" for k in range(len(NUMBERS))]
    types = [f'!{len(NUMBERS) + k} = !{{!"{kind}", !{root}, i64 0}}' for k, kind in enumerate(NUMBERS)]
    return [*accesses, *types, f'!{root} = !{{!"numbers"}}']


def constant(number: bool | int | float) -> Value:
    """Return a literal."""
    if isinstance(number, bool):
        return Value("bool", "true" if number else "false")
    if isinstance(number, int):
        return Value("int", str(number))
    return Value("float", "0x" + struct.pack(">d", number).hex().upper())


def common(values: list[Value]) -> str:
    """Return the kind that holds all values."""
    kinds = {"int" if value.kind == "int32" else value.kind for value in values}
    if len(kinds) == 1:
        return kinds.pop()
    if kinds <= {"bool", "int", "float", "dual"}:
        return next((kind for kind in ("dual", "float") if kind in kinds), "int")
    if kinds == {"quad", "dual quad"}:
        return "dual quad"
    raise Untranslatable(f"found values of kinds {', '.join(sorted(kinds))} for one result")


def _flat(lines: Lines) -> Iterator[str]:
    for line in lines:
        if isinstance(line, list):
            yield from _flat(line)
        else:
            yield line
