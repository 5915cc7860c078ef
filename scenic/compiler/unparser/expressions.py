"""The text of expressions.

Each method of the table at the end writes one class of nodes in a place (see `scenic.compiler.unparser.places`), with
parentheses if the place needs them. They call each other through the table without a step in between, so that a tree
may be as deep as one that the parser makes.
"""

import ast
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from scenic.compiler import tree
from scenic.compiler.precedence import Ladder, forms_of
from scenic.compiler.unparser import places, strings
from scenic.compiler.unparser.errors import UnparseError
from scenic.compiler.unparser.places import (
    ALSO,
    BITOR,
    COMPARISON,
    CONDITION,
    DISJUNCTION,
    EXPRESSION,
    FACTOR,
    FIRST,
    FIRST_OF_CONDITION,
    IDENTITY,
    INVERSION,
    LOOSEST_CONDITION,
    NAMED,
    NEGATED,
    NEW,
    PREFIX,
    PRIMARY,
    RECORD,
    REQUIRE,
    SUM,
    TEMPORAL,
    WATCHED,
    YIELD,
    After,
    Plan,
    absorbs_comma,
    is_keyword,
)

Writer: TypeAlias = Callable[["ExpressionWriter", Any, int, After, str, int], str]


class ExpressionWriter:
    """Writes expressions. ``fields`` is the number of replacement fields of f-strings around the present place."""

    __slots__ = ("fields",)

    def __init__(self) -> None:
        self.fields = 0

    # Lists, and what can stand at the top of a statement.

    def listed(self, nodes: Sequence[ast.expr], level: int) -> str:
        """Elements between brackets, with commas in between."""
        if len(nodes) == 1:
            node = nodes[0]
            return WRITERS[node.__class__](self, node, level, ",", "", PREFIX)
        followers: list[After] = [*nodes[1:], ","]
        return ", ".join(
            [
                WRITERS[node.__class__](self, node, level, after, "", PREFIX)
                for node, after in zip(nodes, followers, strict=False)
            ]
        )

    def bare(self, node: ast.expr, after: After, closer: str = "", lead: int = PREFIX) -> str:
        """Expressions, of which several make a tuple without parentheses."""
        if node.__class__ is not ast.Tuple or not node.elts:
            return WRITERS[node.__class__](self, node, EXPRESSION, after, closer, lead)
        return self.row(node.elts, EXPRESSION, after, closer, lead)

    def bare_or_yield(self, node: ast.expr, after: After, lead: int = PREFIX) -> str:
        """The same, or a `yield`."""
        if node.__class__ is ast.Yield or node.__class__ is ast.YieldFrom:
            return WRITERS[node.__class__](self, node, YIELD, after, "", lead)
        return self.bare(node, after, "", lead)

    def row(self, nodes: Sequence[ast.expr], level: int, after: After, closer: str, lead: int) -> str:
        """The elements of a tuple without parentheses."""
        if len(nodes) == 1:
            return f"{WRITERS[nodes[0].__class__](self, nodes[0], level, ',', '', lead)},"
        texts = []
        others = lead & PREFIX
        last = len(nodes) - 1
        for place, node in enumerate(nodes):
            if place < last:
                texts.append(WRITERS[node.__class__](self, node, level, nodes[place + 1], "", lead))
            else:
                texts.append(WRITERS[node.__class__](self, node, level, after, closer, others))
            lead = others
        return ", ".join(texts)

    def target(self, node: ast.expr, after: After) -> str:
        """A bound expression, where the grammar wants a primary: no operator is tried there."""
        if node.__class__ is ast.Tuple and node.elts:
            return self.row(node.elts, PRIMARY, after, "", 0)
        return WRITERS[node.__class__](self, node, PRIMARY, after, "", 0)

    def expression(self, node: ast.expr, after: After, closer: str = "") -> str:
        """Any expression, but no tuple without parentheses and no assignment."""
        return WRITERS[node.__class__](self, node, EXPRESSION, after, closer, PREFIX)

    def named(self, node: ast.expr, after: After = ":") -> str:
        """Any expression, or an assignment expression."""
        return WRITERS[node.__class__](self, node, NAMED, after, "", PREFIX)

    def in_parentheses(self, node: ast.expr, lead: int) -> str:
        """An expression whose place is too tight, or would give it another meaning."""
        if lead & TEMPORAL:
            return f"({WRITERS[node.__class__](self, node, LOOSEST_CONDITION, ')', '', _GROUP)})"
        return f"({WRITERS[node.__class__](self, node, YIELD, ')', '', PREFIX)})"

    # Atoms.

    def name(self, node: ast.Name, level: int, after: After, closer: str, lead: int) -> str:
        name = node.id
        if name in WATCHED and is_keyword(name, after, closer, lead):
            return f"({name})"
        return name

    def constant(self, node: ast.Constant, level: int, after: After, closer: str, lead: int) -> str:
        value = node.value
        kind = value.__class__
        if kind is str:
            text = strings.plain(value, nested=self.fields % 2 == 1)  # type: ignore[arg-type] # a string
            return f"u{text}" if node.kind == "u" else text
        if kind is int or kind is float or kind is complex:
            text = strings.number(value)  # type: ignore[arg-type] # a number
            if text[0] == "-" or text[0] == "(" or (kind is complex and value.real):  # type: ignore[union-attr]
                written = SUM if kind is complex and value.real else FACTOR  # type: ignore[union-attr]
                return f"({text})" if level > written else text
            return f"({text})" if after == "." and kind is int else text
        if value is None or kind is bool:
            return repr(value)
        if value is Ellipsis:
            return "..."
        if kind is bytes:
            return strings.plain(value, nested=self.fields % 2 == 1)  # type: ignore[arg-type] # bytes
        raise UnparseError(f"a constant of the type `{kind.__name__}` has no text", node)

    def joined_string(self, node: ast.JoinedStr, level: int, after: After, closer: str, lead: int) -> str:
        """An f-string. A part with the prefix `u` is a string of its own beside it."""
        texts: list[str] = []
        run: list[ast.expr] = []
        for part in node.values:
            if isinstance(part, ast.Constant) and part.kind == "u":
                if run:
                    texts.append(self.formatted(run))
                    run = []
                texts.append(f"u{strings.plain(str(part.value), nested=self.fields % 2 == 1)}")
            else:
                run.append(part)
        if run or not any(isinstance(part, ast.FormattedValue) for part in node.values):
            texts.append(self.formatted(run))
        return " ".join(texts)

    def formatted(self, parts: Sequence[ast.expr]) -> str:
        """One f-string."""
        is_nested = self.fields % 2 == 1
        self.fields += 1
        pieces: list[strings.Piece] = []
        for part in parts:
            if isinstance(part, ast.Constant):
                pieces.append(strings.Piece(str(part.value), is_literal=True))
            else:
                pieces += self.field(part)
        self.fields -= 1
        return strings.formatted(pieces, nested=is_nested)

    def field(self, node: Any) -> list[strings.Piece]:
        """A replacement field: its text, and the literal parts of its format specification."""
        if not isinstance(node, ast.FormattedValue):
            raise UnparseError(f"a `{type(node).__name__}` cannot be a part of an f-string", node)
        value = node.value
        text = self.bare_or_yield(value, "}")
        if "lambda" in text and value.__class__ is not ast.Starred:
            # The colon would begin the format specification.
            text = f"({text})"
        start = "{ " if text[0] == "{" else "{"
        conversion = f"!{chr(node.conversion)}" if node.conversion != -1 else ""
        if node.format_spec is None:
            return [strings.Piece(f"{start}{text}{conversion}}}")]
        pieces = [strings.Piece(f"{start}{text}{conversion}:")]
        specification: Any = node.format_spec
        for part in specification.values:
            if isinstance(part, ast.Constant):
                pieces.append(strings.Piece(str(part.value), is_literal=True, in_specification=True))
            else:
                pieces += self.field(part)
        pieces.append(strings.Piece("}"))
        return pieces

    def list_display(self, node: ast.List, level: int, after: After, closer: str, lead: int) -> str:
        text = f"[{self.listed(node.elts, NAMED)}]" if node.elts else "[]"
        # `require [0.5] (x)` has a probability.
        if (
            lead & REQUIRE
            and len(node.elts) == 1
            and after in places.OPERAND_STARTS
            and text[1] in ".0123456789"
        ):
            return f"({text})"
        return text

    def tuple_display(self, node: ast.Tuple, level: int, after: After, closer: str, lead: int) -> str:
        if not node.elts:
            return "()"
        return f"({self.row(node.elts, NAMED, ',', '', PREFIX)})"

    def set_display(self, node: ast.Set, level: int, after: After, closer: str, lead: int) -> str:
        if not node.elts:
            raise UnparseError("there is no text for the empty set", node)
        return f"{{{self.listed(node.elts, NAMED)}}}"

    def dictionary(self, node: ast.Dict, level: int, after: After, closer: str, lead: int) -> str:
        items = []
        count = len(node.keys)
        for place, (key, value) in enumerate(zip(node.keys, node.values, strict=True), start=1):
            following = node.keys[place] if place < count else None
            follower = "," if following is None else following
            if key is None:
                items.append(f"**{WRITERS[value.__class__](self, value, BITOR, follower, '', PREFIX)}")
            else:
                written = WRITERS[key.__class__](self, key, EXPRESSION, ":", "", PREFIX)
                text = WRITERS[value.__class__](self, value, EXPRESSION, follower, "", PREFIX)
                items.append(f"{written}: {text}")
        return f"{{{', '.join(items)}}}"

    def list_comprehension(self, node: Any, level: int, after: After, closer: str, lead: int) -> str:
        return f"[{self.named(node.elt, 'for')}{self.loops(node.generators)}]"

    def set_comprehension(self, node: Any, level: int, after: After, closer: str, lead: int) -> str:
        return f"{{{self.named(node.elt, 'for')}{self.loops(node.generators)}}}"

    def generator(self, node: Any, level: int, after: After, closer: str, lead: int) -> str:
        return f"({self.named(node.elt, 'for')}{self.loops(node.generators)})"

    def dictionary_comprehension(self, node: Any, level: int, after: After, closer: str, lead: int) -> str:
        key, value = self.expression(node.key, ":"), self.expression(node.value, "for")
        return f"{{{key}: {value}{self.loops(node.generators)}}}"

    def loops(self, generators: Sequence[ast.comprehension]) -> str:
        """The `for` and `if` of a comprehension."""
        texts = []
        for each in generators:
            word = " async for" if each.is_async else " for"
            texts.append(f"{word} {self.target(each.target, 'in')} in ")
            rest = [each.iter, *each.ifs]
            texts.append(
                " if ".join(
                    [WRITERS[node.__class__](self, node, DISJUNCTION, "if", "", PREFIX) for node in rest[:-1]]
                    + [WRITERS[rest[-1].__class__](self, rest[-1], DISJUNCTION, "for", "", PREFIX)]
                )
            )
        return "".join(texts)

    # Primaries.

    def attribute(self, node: ast.Attribute, level: int, after: After, closer: str, lead: int) -> str:
        value = node.value
        return f"{WRITERS[value.__class__](self, value, PRIMARY, '.', closer, lead & FIRST)}.{node.attr}"

    def call(self, node: ast.Call, level: int, after: After, closer: str, lead: int) -> str:
        function = node.func
        text = WRITERS[function.__class__](self, function, PRIMARY, "(", closer, lead & FIRST)
        arguments = node.args
        if not node.keywords:
            if not arguments:
                return f"{text}()"
            if len(arguments) == 1:
                argument = arguments[0]
                if argument.__class__ is ast.GeneratorExp:
                    return text + self.generator(argument, NAMED, "", "", PREFIX)
                if argument.__class__ is not ast.Starred:
                    return f"{text}({WRITERS[argument.__class__](self, argument, NAMED, ',', '', PREFIX)})"
        return f"{text}({self.arguments(arguments, node.keywords)})"

    def arguments(self, positional: Sequence[ast.expr], keywords: Sequence[ast.keyword]) -> str:
        """The arguments of a call, or the bases of a class."""
        nodes: list[Any] = [*positional, *keywords]
        followers: list[After] = [*nodes[1:], ","]
        texts = []
        for node, after in zip(nodes, followers, strict=False):
            kind = node.__class__
            if kind is ast.keyword:
                value = node.value
                text = WRITERS[value.__class__](self, value, EXPRESSION, after, "", PREFIX)
                texts.append(f"**{text}" if node.arg is None else f"{node.arg}={text}")
            elif kind is ast.Starred:
                value = node.value
                texts.append(f"*{WRITERS[value.__class__](self, value, EXPRESSION, after, '', PREFIX)}")
            else:
                texts.append(WRITERS[kind](self, node, NAMED, after, "", PREFIX))
        return ", ".join(texts)

    def subscript(self, node: ast.Subscript, level: int, after: After, closer: str, lead: int) -> str:
        value, index = node.value, node.slice
        text = WRITERS[value.__class__](self, value, PRIMARY, "[", closer, lead & FIRST)
        if index.__class__ is ast.Tuple and index.elts:
            elements = index.elts
            if len(elements) == 1 and elements[0].__class__ is ast.Starred:
                return f"{text}[{self.listed(elements, NAMED)}]"
            return f"{text}[{self.row(elements, NAMED, ',', '', PREFIX)}]"
        return f"{text}[{WRITERS[index.__class__](self, index, NAMED, ',', '', PREFIX)}]"

    def slice(self, node: ast.Slice, level: int, after: After, closer: str, lead: int) -> str:
        text = self.expression(node.lower, ":") if node.lower else ""
        text += ":"
        if node.upper:
            text += self.expression(node.upper, ":" if node.step else after)
        if node.step:
            text += f":{self.expression(node.step, after)}"
        return text

    def starred(self, node: ast.Starred, level: int, after: After, closer: str, lead: int) -> str:
        value = node.value
        inner = PRIMARY if level == PRIMARY else BITOR
        lead = 0 if level == PRIMARY else PREFIX
        return f"*{WRITERS[value.__class__](self, value, inner, after, closer, lead)}"

    # Python's operators.

    def binary(self, node: ast.BinOp, level: int, after: After, closer: str, lead: int) -> str:
        plan = places.BINARY.get(node.op.__class__)
        if plan is None:
            raise UnparseError(
                f"the operator `{type(node.op).__name__}` has no text: Scenic reads its sign otherwise", node
            )
        if level > plan.level:
            return self.in_parentheses(node, lead)
        # A long sum is a long chain of first operands: it is written from its end, so as not to copy it at each step.
        right = node.right
        texts = [WRITERS[right.__class__](self, right, plan.right, after, closer, plan.lead), plan.text]
        left = node.left
        while left.__class__ is ast.BinOp:
            inner = places.BINARY.get(left.op.__class__)
            if inner is None or plan.left > inner.level:
                break
            right = left.right
            texts.append(WRITERS[right.__class__](self, right, inner.right, plan.symbol, closer, inner.lead))
            texts.append(inner.text)
            left = left.left
            plan = inner
        texts.append(WRITERS[left.__class__](self, left, plan.left, plan.symbol, closer, lead & FIRST))
        texts.reverse()
        return "".join(texts)

    def unary(self, node: ast.UnaryOp, level: int, after: After, closer: str, lead: int) -> str:
        kind = node.op.__class__
        operand = node.operand
        if kind is ast.Not:
            if level > INVERSION:
                return self.in_parentheses(node, lead)
            inner = _NOT_OF_CONDITION if lead & TEMPORAL else PREFIX | NEGATED
            text = WRITERS[operand.__class__](self, operand, INVERSION, after, closer, inner)
            return f"not {text}"
        if level > FACTOR:
            return self.in_parentheses(node, lead)
        return f"{places.UNARY[kind]}{WRITERS[operand.__class__](self, operand, FACTOR, after, closer, 0)}"

    def boolean(self, node: ast.BoolOp, level: int, after: After, closer: str, lead: int) -> str:
        written, operand, word = _BOOLEAN[node.op.__class__]
        if level > written:
            return self.in_parentheses(node, lead)
        if lead & TEMPORAL:
            first, others = lead & FIRST_OF_CONDITION, _GROUP | ALSO
        else:
            first, others = lead & FIRST, PREFIX
        texts = []
        last = len(node.values) - 1
        for place, value in enumerate(node.values):
            follower = word if place < last else after
            texts.append(WRITERS[value.__class__](self, value, operand, follower, closer, first))
            first = others
        return f" {word} ".join(texts)

    def comparison(self, node: ast.Compare, level: int, after: After, closer: str, lead: int) -> str:
        if level > COMPARISON:
            return self.in_parentheses(node, lead)
        operators = [places.COMPARED[each.__class__] for each in node.ops]
        left = node.left
        texts = [WRITERS[left.__class__](self, left, BITOR, operators[0][0], closer, lead & FIRST)]
        last = len(operators) - 1
        for place, (operator, right) in enumerate(zip(operators, node.comparators, strict=True)):
            follower = operators[place + 1][0] if place < last else after
            flags = PREFIX | IDENTITY if operator[1] == "is" else PREFIX
            text = WRITERS[right.__class__](self, right, BITOR, follower, closer, flags)
            texts.append(f" {operator[1]} {text}")
        return "".join(texts)

    def conditional(self, node: ast.IfExp, level: int, after: After, closer: str, lead: int) -> str:
        if lead & TEMPORAL:
            written, inner = LOOSEST_CONDITION, LOOSEST_CONDITION + 1
            first, others = lead & FIRST_OF_CONDITION, _GROUP
        else:
            written, inner = EXPRESSION, DISJUNCTION
            first, others = lead & FIRST, PREFIX
        if level > written:
            return self.in_parentheses(node, lead)
        body, test, orelse = node.body, node.test, node.orelse
        return (
            f"{WRITERS[body.__class__](self, body, inner, 'if', closer, first)} if "
            f"{WRITERS[test.__class__](self, test, inner, 'else', 'else', others)} else "
            f"{WRITERS[orelse.__class__](self, orelse, written, after, closer, others)}"
        )

    def function(self, node: ast.Lambda, level: int, after: After, closer: str, lead: int) -> str:
        if level > (LOOSEST_CONDITION if lead & TEMPORAL else EXPRESSION):
            return self.in_parentheses(node, lead)
        parameters = self.parameters(node.args)
        body = WRITERS[node.body.__class__](self, node.body, EXPRESSION, after, closer, PREFIX)
        return f"lambda {parameters}: {body}" if parameters else f"lambda: {body}"

    def parameters(self, node: ast.arguments) -> str:
        """The parameters of a function, without their parentheses."""
        positional = [*node.posonlyargs, *node.args]
        defaults = [None] * (len(positional) - len(node.defaults)) + list(node.defaults)
        items: list[tuple[str, ast.arg | None, ast.expr | None]] = []
        for place, (parameter, default) in enumerate(zip(positional, defaults, strict=True), start=1):
            items.append(("", parameter, default))
            if place == len(node.posonlyargs):
                items.append(("/", None, None))
        if node.vararg:
            items.append(("*", node.vararg, None))
        elif node.kwonlyargs:
            items.append(("*", None, None))
        items += [("", each, value) for each, value in zip(node.kwonlyargs, node.kw_defaults, strict=True)]
        if node.kwarg:
            items.append(("**", node.kwarg, None))
        return ", ".join(
            [
                self.parameter(*item, items[place][1] or "," if place < len(items) else ",")
                for place, item in enumerate(items, start=1)
            ]
        )

    def parameter(self, stars: str, node: ast.arg | None, default: ast.expr | None, after: After) -> str:
        """One parameter; ``stars`` may stand alone."""
        if node is None:
            return stars
        text = f"{stars}{node.arg}"
        if node.annotation:
            text += f": {self.expression(node.annotation, after if default is None else '=')}"
            return text if default is None else f"{text} = {self.expression(default, after)}"
        return text if default is None else f"{text}={self.expression(default, after)}"

    def assignment(self, node: ast.NamedExpr, level: int, after: After, closer: str, lead: int) -> str:
        if level > NAMED or lead & TEMPORAL:
            return f"({self.assignment(node, NAMED, ')', '', PREFIX)})"
        return f"{node.target.id} := {self.expression(node.value, after, closer)}"

    def awaited(self, node: ast.Await, level: int, after: After, closer: str, lead: int) -> str:
        if level >= PRIMARY:
            return self.in_parentheses(node, lead)
        value = node.value
        return f"await {WRITERS[value.__class__](self, value, PRIMARY, after, closer, 0)}"

    def yielded(self, node: ast.Yield, level: int, after: After, closer: str, lead: int) -> str:
        if level > YIELD or lead & TEMPORAL:
            return f"({self.yielded(node, YIELD, ')', '', PREFIX)})"
        return f"yield {self.bare(node.value, after, closer)}" if node.value else "yield"

    def yielded_from(self, node: ast.YieldFrom, level: int, after: After, closer: str, lead: int) -> str:
        if level > YIELD or lead & TEMPORAL:
            return f"({self.yielded_from(node, YIELD, ')', '', PREFIX)})"
        return f"yield from {self.expression(node.value, after, closer)}"

    # Scenic's operators and instances.

    def operation(self, node: tree.Operation, level: int, after: After, closer: str, lead: int) -> str:
        plan = self.plan(places.OPERATIONS, node.operator, node)
        if level > plan.level or closer in plan.absorbs or lead & plan.clashes:
            return self.in_parentheses(node, lead)
        if not plan.operands:
            return f"({plan.head})" if lead & RECORD else plan.head
        return self.operands(node.operands, plan, after, closer, lead & FIRST)

    def temporal(self, node: tree.Temporal, level: int, after: After, closer: str, lead: int) -> str:
        plan = self.plan(places.CONDITIONS, node.operator, node)
        if not lead & TEMPORAL:
            raise UnparseError(f"`{node.operator}` has no text outside the condition of a `require`", node)
        if (level > plan.level and not (lead & ALSO and plan.head)) or after in plan.absorbs:
            return self.in_parentheses(node, lead)
        return self.operands(node.operands, plan, after, closer, lead & FIRST_OF_CONDITION)

    def plan(self, plans: Mapping[tuple[str, tuple[int, ...]], Plan], name: str, node: Any) -> Plan:
        """The plan by which to write an operator with the operands that it has."""
        operands = node.operands
        absent = () if None not in operands else tuple(i for i, each in enumerate(operands) if each is None)
        plan = plans.get((name, absent))
        if plan is None or len(plan.operands) != len(operands) - len(absent):
            raise UnparseError(f"`{name}` with these operands has no text", node)
        return plan

    def operands(self, operands: Sequence[Any], plan: Plan, after: After, closer: str, first: int) -> str:
        """The text of a form; ``first`` are the flags of an operand that begins it."""
        texts = [plan.head]
        for place in plan.operands:
            node = operands[place.index]
            texts.append(
                WRITERS[node.__class__](
                    self,
                    node,
                    place.level,
                    after if place.after is None else place.after,
                    closer if place.closer is None else place.closer,
                    first if place.lead is None else place.lead,
                )
            )
            texts.append(place.text)
        return "".join(texts)

    def new(self, node: tree.New, level: int, after: After, closer: str, lead: int) -> str:
        if level > NEW:
            return self.in_parentheses(node, lead)
        if not node.specifiers:
            if after in places.SPECIFIER_STARTS:
                return self.in_parentheses(node, lead)
            return f"new {node.cls.id}"
        last = node.specifiers[-1]
        plan = self.plan(places.SPECIFIER_PLANS, last.specifier, last)
        if (
            (plan.is_open and after in places.INFIX)
            or closer in plan.absorbs
            or after in plan.absorbs
            or absorbs_comma(after)
        ):
            return self.in_parentheses(node, lead)
        return f"new {node.cls.id} {self.specifiers(node.specifiers, after, closer)}"

    def specifiers(self, nodes: Sequence[tree.SpecifierPhrase], after: After, closer: str) -> str:
        """A list of specifiers."""
        texts = []
        last = len(nodes) - 1
        for place, node in enumerate(nodes):
            plan = self.plan(places.SPECIFIER_PLANS, node.specifier, node)
            text = (
                self.operands(node.operands, plan, nodes[place + 1], "", 0)
                if place < last
                else self.operands(node.operands, plan, after, closer, 0)
            )
            texts.append(text.replace("%s", str(node.property), 1) if node.property is not None else text)
        return ", ".join(texts)


_GROUP: Final = PREFIX | CONDITION | TEMPORAL
"""The flags of the operands of the temporal ladder."""
_NOT_OF_CONDITION: Final = _GROUP | ALSO | NEGATED


def _boolean(operator: str) -> tuple[int, int, str]:
    form = forms_of("BoolOp", operator, Ladder.ORDINARY)[0]
    return (form.level, form.slots[0].level, form.words[0])


_BOOLEAN: Final[Mapping[type[ast.boolop], tuple[int, int, str]]] = MappingProxyType(
    {ast.And: _boolean("And"), ast.Or: _boolean("Or")}
)
"""The levels of `and` and `or`, which are the same in both ladders, and of their operands."""


class _Writers(dict[type[ast.AST], Writer]):
    """The table; what is not in it has no text."""

    def __missing__(self, kind: type[ast.AST]) -> Writer:
        return _refuse


def _refuse(_writer: ExpressionWriter, node: Any, *_place: Any) -> str:
    raise UnparseError(f"a `{type(node).__name__}` has no text as an expression", node)


WRITERS: Final = _Writers(
    {
        ast.Attribute: ExpressionWriter.attribute,
        ast.Await: ExpressionWriter.awaited,
        ast.BinOp: ExpressionWriter.binary,
        ast.BoolOp: ExpressionWriter.boolean,
        ast.Call: ExpressionWriter.call,
        ast.Compare: ExpressionWriter.comparison,
        ast.Constant: ExpressionWriter.constant,
        ast.Dict: ExpressionWriter.dictionary,
        ast.DictComp: ExpressionWriter.dictionary_comprehension,
        ast.GeneratorExp: ExpressionWriter.generator,
        ast.IfExp: ExpressionWriter.conditional,
        ast.JoinedStr: ExpressionWriter.joined_string,
        ast.Lambda: ExpressionWriter.function,
        ast.List: ExpressionWriter.list_display,
        ast.ListComp: ExpressionWriter.list_comprehension,
        ast.Name: ExpressionWriter.name,
        ast.NamedExpr: ExpressionWriter.assignment,
        ast.Set: ExpressionWriter.set_display,
        ast.SetComp: ExpressionWriter.set_comprehension,
        ast.Slice: ExpressionWriter.slice,
        ast.Starred: ExpressionWriter.starred,
        ast.Subscript: ExpressionWriter.subscript,
        ast.Tuple: ExpressionWriter.tuple_display,
        ast.UnaryOp: ExpressionWriter.unary,
        ast.Yield: ExpressionWriter.yielded,
        ast.YieldFrom: ExpressionWriter.yielded_from,
        tree.New: ExpressionWriter.new,
        tree.Operation: ExpressionWriter.operation,
        tree.Temporal: ExpressionWriter.temporal,
    }
)
