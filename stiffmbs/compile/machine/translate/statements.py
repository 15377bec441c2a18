"""Translation of statements."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from .arithmetic import computed
from .code import Code, Lines, common
from .expressions import Expressions
from .values import Operand, Passed, Record, Untranslatable, Value, refuse, renamed


class Statements:
    """Translator of the body of one function. `returned`: place of the instructions and value of each return."""

    def __init__(self, code: Code, expressions: Expressions) -> None:
        self.code, self.expressions = code, expressions
        self.returned: list[tuple[Lines, Value | None]] = []
        self._loops: list[tuple[str, str]] = []

    def write(self, body: Sequence[ast.stmt]) -> None:
        """Write the instructions of statements, up to one that ends the block."""
        for statement in body:
            if not self.code.reached:
                return
            try:
                self._write(statement)
            except Untranslatable as error:
                raise error if str(error).startswith("line") else refuse(statement, str(error)) from None

    def _write(self, statement: ast.stmt) -> None:
        code, value = self.code, self.expressions.value
        match statement:
            case ast.Expr(ast.Constant()):
                return
            case ast.Expr(expression):
                value(expression)
            case ast.Assign([target], expression):
                self._assign(target, value(expression))
            case ast.AugAssign(ast.Name() as target, operation, expression):
                old = value(ast.Name(target.id))
                self._assign(target, computed(code, operation, old, value(expression)))
            case ast.AugAssign(ast.Subscript() | ast.Attribute() as target, operation, expression):
                place = self.expressions.place(target)
                old = code.load(place)
                code.store(place, computed(code, operation, old, value(expression)))
            case ast.If(test, then, otherwise):
                self._if(test, then, otherwise)
            case ast.While(test, body, []):
                self._while(test, body)
            case ast.For(ast.Name(name), ast.Call(ast.Name("range"), limits), body, []):
                self._for(name, [code.integer(value(limit)) for limit in limits], body)
            case ast.Break() | ast.Continue():
                code.branch(self._loops[-1][isinstance(statement, ast.Continue)])
            case ast.Return(None):
                self.leave(None)
            case ast.Return(expression) if expression is not None:
                self.leave(value(expression))
            case _:
                raise refuse(statement, "not of the language")

    def leave(self, value: Operand | None) -> None:
        """Return from the function; the instruction is written when all returns are known."""
        if not isinstance(value, Value | None):
            raise Untranslatable("a function returns one number or pointer")
        self.returned.append((self.code.gap(), value))
        self.code.reached = False

    def finish(self, wanted: str | None) -> str | None:
        """Write all returns, converted to the wanted kind if given; return the function's kind."""
        if self.code.reached:
            self.leave(None)
        values = [value for _, value in self.returned if value is not None]
        if values and len(values) < len(self.returned):
            raise Untranslatable("the function returns a value on some of its ways only")
        kind = (wanted or common(values)) if values else None
        for gap, value in self.returned:
            with self.code.within(gap):
                found = self.code.packed(self.code.converted(value, kind)) if value and kind else None
                self.code.put(f"ret {found.typed}" if found else "ret void")
        return kind

    def _assign(self, target: ast.expr, value: Operand | None) -> None:
        expressions, code = self.expressions, self.code
        match target, value:
            case ast.Name(name), Value():
                expressions.set(name, value)
            case ast.Name(name), Record() if name not in expressions.records:
                expressions.records[name] = value
            case ((ast.Subscript() | ast.Attribute()), Value()):
                code.store(expressions.place(target), value)
            case ast.Tuple(targets), tuple() if len(targets) == len(value):
                for part, own in zip(targets, value, strict=True):
                    self._assign(part, own)
            case _:
                raise Untranslatable("an assignment that is not of the language")

    def _if(self, test: ast.expr, then: list[ast.stmt], otherwise: list[ast.stmt]) -> None:
        code = self.code
        first, second, end = code.name("then"), code.name("else"), code.name("end")
        code.choose(self.expressions.truth(test), first, second)
        code.label(first)
        with self.expressions.block():
            self.write(then)
        if code.reached:
            code.branch(end)
        code.label(second)
        with self.expressions.block():
            self.write(otherwise)
        code.label(end)

    def _while(self, test: ast.expr, body: list[ast.stmt]) -> None:
        code = self.code
        head, inside, end = code.name("while"), code.name("body"), code.name("end")
        code.label(head)
        if isinstance(test, ast.Constant) and test.value is True:
            code.branch(inside)
        else:
            code.choose(self.expressions.truth(test), inside, end)
        code.label(inside)
        with self.expressions.block():
            self._loop(body, end, head)
        if code.reached:
            code.branch(head)
        code.label(end)

    def _for(self, name: str, limits: list[Value], body: list[ast.stmt]) -> None:
        """Translate a loop over a range with a literal step; limits are evaluated once, as in Python."""
        code = self.code
        start, stop = limits[:2] if len(limits) > 1 else (Value("int", "0"), limits[0])
        step = int(limits[2].text) if len(limits) > 2 else 1
        counter = code.variable("int")
        code.store(counter, start)
        head, inside, following, end = (code.name(label) for label in ("for", "body", "following", "end"))
        code.label(head)
        now = code.load(counter)
        code.choose(
            code.put_value("bool", f"icmp {'slt' if step > 0 else 'sgt'} {now.typed}, {stop.text}"), inside, end
        )
        code.label(inside)
        with self.expressions.block():
            self._assign(ast.Name(name), now)
            self._loop(body, end, following)
        code.label(following)
        if code.reached:
            code.store(counter, code.put_value("int", f"add nsw {code.load(counter).typed}, {step}"))
            code.branch(head)
        code.label(end)

    def _loop(self, body: list[ast.stmt], end: str, following: str) -> None:
        self._loops.append((end, following))
        self.write(body)
        self._loops.pop()


def parameters(names: Sequence[str], values: Sequence[Operand], expressions: Expressions) -> list[str]:
    """Make a function's parameters its variables, each field of a view separately; return their declarations."""
    declared = []
    for name, value in zip(names, values, strict=True):
        if isinstance(value, Record):
            fields = {field: renamed(own, f"%{name}.{field}") for field, own in value.fields.items()}
            expressions.records[name] = Record(value.name, fields)
            declared += [own.typed for own in fields.values()]
        elif isinstance(value, Value):
            given = renamed(value, f"%{name}.")
            expressions.set(name, given)
            declared.append(given.typed)
        elif isinstance(value, Passed):
            expressions.passed[name] = value.function
        else:
            raise Untranslatable(f"{name}: found a tuple, expected a value or a view")
    return declared
