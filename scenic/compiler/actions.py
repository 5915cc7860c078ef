"""What the grammar's actions call: the parts of building a tree that are more than making a node.

A method that returns ``None`` makes its alternative fail; before that it notes why with `Actions.fail`, which the
messages prefer to what the parser expected. What is wrong without making the text unreadable is reported instead.

Positions here are those of tokens and nodes: lines from 1, columns in UTF-8 bytes. A *place* is a quadruple of them.
"""

import ast
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from scenic.compiler import formatted, literals, tree
from scenic.compiler.lexer import Tokens

Place: TypeAlias = tuple[int, int, int, int]
Parameter: TypeAlias = tuple[Any, Any]

LOAD: Final = ast.Load()
STORE: Final = ast.Store()
DELETE: Final = ast.Del()


@dataclass(frozen=True, slots=True)
class Problem:
    """A problem at a place, before it is a diagnostic."""

    code: str
    place: Place
    message: str
    help: str | None = None


def place_of(node: ast.AST) -> Place:
    """The place of a node."""
    located: Any = node
    return (located.lineno, located.col_offset, located.end_lineno, located.end_col_offset)


class Actions:
    """The functions that the grammar's actions call, for the tokens of one text."""

    def __init__(self, tokens: Tokens) -> None:
        self._tokens = tokens
        self._texts = tokens.texts
        self.problems: dict[tuple[str, Place], Problem] = {}
        self.failure: Problem | None = None

    # Problems.

    def fail(self, place: Place, message: str, *, help: str | None = None, code: str = "SC110") -> None:
        """Note why the alternative being parsed fails; the first reason counts."""
        if self.failure is None:
            self.failure = Problem(code, place, message, help)

    def _report(self, place: Place, message: str, *, help: str | None = None, code: str) -> None:
        self.problems.setdefault((code, place), Problem(code, place, message, help))

    def place_of_token(self, index: int) -> Place:
        """The place of a token."""
        tokens = self._tokens
        return (
            tokens.lines[index],
            tokens.columns[index],
            tokens.end_lines[index],
            tokens.end_columns[index],
        )

    # Lists.

    def module(self, statements: list[Any]) -> ast.Module:
        return ast.Module(body=self.flat(statements), type_ignores=[])

    def flat(self, statements: list[Any]) -> list[ast.stmt]:
        """Statements, of which those of one line come as a list."""
        for statement in statements:
            if type(statement) is list:
                break
        else:
            return statements
        flat: list[ast.stmt] = []
        for statement in statements:
            if type(statement) is list:
                flat += statement
            else:
                flat.append(statement)
        return flat

    def joined(self, lists: Iterable[list[Any]]) -> list[Any]:
        return [element for each in lists for element in each]

    def words(self, indices: Iterable[int]) -> list[str]:
        texts = self._texts
        return [texts[index] for index in indices]

    def count_dots(self, indices: Iterable[int]) -> int:
        return sum(len(self._texts[index]) for index in indices)

    # Targets.

    def storable(self, node: ast.expr) -> ast.expr | None:
        """Make a target of an expression, in place; ``None`` if it cannot be one."""
        if type(node) is ast.Name:
            node.ctx = STORE
            return node
        return self._targeted(node, STORE, "assign to")

    def _targeted(self, node: ast.expr, context: ast.expr_context, verb: str) -> ast.expr | None:
        stack = [node]
        while stack:
            target: Any = stack.pop()
            kind = type(target)
            if kind is ast.Name or kind is ast.Attribute or kind is ast.Subscript:
                target.ctx = context
            elif kind is ast.Tuple or kind is ast.List:
                target.ctx = context
                stack += reversed(target.elts)
            elif kind is ast.Starred and context is STORE:
                target.ctx = context
                stack.append(target.value)
            else:
                what = describe(target)
                self.fail(
                    place_of(target),
                    f"cannot {verb} {what}",
                    help="use `==` to compare" if verb == "assign to" else None,
                )
                return None
        return node

    def assigned(self, first: ast.expr, rest: Sequence[ast.expr]) -> bool:
        """Make targets of all values of an assignment but the last."""
        return self.storable(first) is not None and all(
            self.storable(target) is not None for target in rest[:-1]
        )

    def annotatable(self, node: ast.expr) -> bool:
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript):
            node.ctx = STORE
            return True
        self.fail(
            place_of(node), f"only a name, an attribute or an item can be annotated, not {describe(node)}"
        )
        return False

    def is_simple(self, node: ast.expr, start: int) -> int:
        """Whether the target of an annotation is a bare name."""
        return int(isinstance(node, ast.Name) and self._tokens.kinds[start] >= 256)

    def augmentable(self, node: ast.expr) -> bool:
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript):
            node.ctx = STORE
            return True
        self.fail(place_of(node), f"{describe(node)} cannot be changed by an operator and assigned at once")
        return False

    def deletable(self, targets: Iterable[ast.expr]) -> bool:
        return all(self._targeted(target, DELETE, "delete") is not None for target in targets)

    def stored_name(self, index: int) -> ast.Name:
        node = ast.Name(id=self._texts[index], ctx=STORE)
        self._put(node, self.place_of_token(index))
        return node

    @staticmethod
    def _put(node: Any, place: Place) -> None:
        node.lineno, node.col_offset, node.end_lineno, node.end_col_offset = place

    # Definitions.

    def no_parameters(self) -> ast.arguments:
        return ast.arguments(
            posonlyargs=[], args=[], vararg=None, kwonlyargs=[], kw_defaults=[], kwarg=None, defaults=[]
        )

    def parameters(self, items: Sequence[Parameter]) -> ast.arguments | None:
        """Sort the items of a signature, and check their order."""
        result = self.no_parameters()
        star: ast.arg | bool = False
        for key, value in items:
            if result.kwarg is not None:
                where = self.place_of_token(value) if key == "/" else self._place_of_parameter(key, value)
                self.fail(where or place_of(result.kwarg), "nothing may follow a parameter with `**`")
                return None
            if key == "/":
                if star is not False or result.posonlyargs or not result.args:
                    self.fail(
                        self.place_of_token(value),
                        "`/` has to stand once, after the first parameters and before `*`",
                    )
                    return None
                result.posonlyargs, result.args = result.args, []
            elif key == "*":
                if star is not False:
                    self.fail(
                        self._place_of_parameter(key, value) or self._last_place(items),
                        "`*` may stand only once",
                    )
                    return None
                star = True if value is None else value
                result.vararg = value
            elif key == "**":
                result.kwarg = value
            elif star is not False:
                result.kwonlyargs.append(key)
                result.kw_defaults.append(value)
            else:
                if value is not None:
                    result.defaults.append(value)
                elif result.defaults:
                    self.fail(place_of(key), "a parameter without a default follows one with a default")
                    return None
                result.args.append(key)
        if star is True and not result.kwonlyargs:
            self.fail(self._last_place(items), "a name has to follow the bare `*`")
            return None
        return result

    def _place_of_parameter(self, key: object, value: object) -> Place | None:
        node = key if isinstance(key, ast.AST) else value
        return place_of(node) if isinstance(node, ast.AST) else None

    def _last_place(self, items: Sequence[Parameter]) -> Place:
        for key, value in reversed(items):
            place = None if key == "/" else self._place_of_parameter(key, value)
            if place is not None:
                return place
            if key == "/":
                return self.place_of_token(value)
        # Nothing but a star, which stands between the parentheses that were read last.
        return (1, 0, 1, 0)

    def type_parameter(self, kind: str, name: int, bound: ast.expr | None, place: Place) -> Any:
        node_class = getattr(ast, kind, None)
        if node_class is None:
            return place
        fields: dict[str, Any] = {"name": self._texts[name]}
        if kind == "TypeVar":
            fields["bound"] = bound
        if "default_value" in node_class._fields:
            fields["default_value"] = None
        node = node_class(**fields)
        self._put(node, place)
        return node

    def _type_parameters(self, parameters: list[Any] | None) -> list[Any]:
        if parameters and isinstance(parameters[0], tuple):
            self._newer(parameters[0], "type parameters")
            return []
        return parameters or []

    def _newer(self, place: Place, what: str) -> None:
        self._report(
            place, f"{what} need Python 3.12 or newer", code="SC120", help="run Scenic with a newer Python"
        )

    def type_alias(self, name: int, parameters: list[Any] | None, value: ast.expr, place: Place) -> ast.stmt:
        node_class = getattr(ast, "TypeAlias", None)
        if node_class is None:
            self._newer(place, "`type` statements")
            node: Any = tree.ErrorStatement(body=[])
        else:
            target = self.stored_name(name)
            node = node_class(name=target, type_params=parameters or [], value=value)
        self._put(node, place)
        return node  # type: ignore[no-any-return]

    def function(
        self, node_class: Any, signature: tuple[Any, ...], body: list[ast.stmt], place: Place
    ) -> Any:
        name, type_parameters, parameters, returns = signature
        node = node_class.__new__(node_class)
        node.__dict__ = {
            "name": self._texts[name],
            "args": parameters or self.no_parameters(),
            "body": body,
            "decorator_list": [],
            "returns": returns,
            "type_comment": None,
            "type_params": self._type_parameters(type_parameters),
        }
        self._put(node, place)
        return node

    def class_definition(
        self,
        name: int,
        type_parameters: list[Any] | None,
        bases: list[Any] | None,
        body: list[ast.stmt],
        place: Place,
    ) -> ast.ClassDef | None:
        arguments, keywords, generator = (bases[0] if bases else None) or ([], [], None)
        if generator is not None:
            self.fail(place_of(generator), "a class cannot have a generator as its base")
            return None
        node = ast.ClassDef.__new__(ast.ClassDef)
        node.__dict__ = {
            "name": self._texts[name],
            "bases": arguments,
            "keywords": keywords,
            "body": body,
            "decorator_list": [],
            "type_params": self._type_parameters(type_parameters),
        }
        self._put(node, place)
        return node

    def decorate(self, decorators: list[ast.expr], definition: Any) -> Any:
        definition.decorator_list = decorators
        return definition

    def try_statement(self, body: list[ast.stmt], rest: tuple[Any, ...], place: Place) -> Any:
        interrupts, handlers, orelse, final, node_class = rest
        for handler in handlers[:-1]:
            if handler.type is None:
                self.fail(place_of(handler), "an `except` without an expression has to be the last one")
                return None
        fields = {
            "body": body,
            "handlers": handlers,
            "orelse": orelse or [],
            "finalbody": final or [],
        }
        if interrupts is not None:
            fields["interrupts"] = interrupts
        node = node_class(**fields)
        self._put(node, place)
        return node

    # Scenic's definitions and statements.

    def no_later_guard(self, body: Iterable[ast.stmt]) -> bool:
        """Refuse guards among the statements of a behavior; there they would be annotations."""
        for statement in body:
            word = _guard_word(statement)
            if word is not None:
                self.fail(place_of(statement), f"`{word}` has to stand before all other statements")
                return False
        return True

    def no_guard(self, body: Iterable[ast.stmt]) -> bool:
        for statement in body:
            word = _guard_word(statement)
            if word is not None:
                self.fail(
                    place_of(statement),
                    f"a monitor cannot have an `{word}`"
                    if word[0] == "i"
                    else f"a monitor cannot have a `{word}`",
                    help="only behaviors and scenarios have guards",
                )
                return False
        return True

    def one_block(self, body: list[ast.stmt]) -> tuple[Any, ...] | None:
        """The parts of a scenario that is all set-up."""
        if not self.no_later_guard(body):
            return None
        if _docstring(body[0]) is not None:
            return (body[0], [], body[1:], None)
        return (None, [], body, None)

    def scenario(
        self, name: int, parameters: list[Any] | None, parts: tuple[Any, ...], place: Place
    ) -> tree.ScenarioDef | None:
        opening, guards, setup, compose = parts
        docstring = None
        if opening is not None:
            docstring = _docstring(opening)
            if docstring is None:
                self.fail(place_of(opening), "only a plain string can stand here, as documentation")
                return None
        arguments = None
        if parameters is not None:
            arguments = parameters[0] or self.no_parameters()
        node = tree.ScenarioDef(
            name=self._texts[name],
            args=arguments,
            docstring=docstring,
            guards=guards,
            setup=setup,
            compose=compose,
        )
        self._put(node, place)
        return node

    def distinct(self, items: Sequence[tree.ParamItem]) -> bool:
        """Report parameters that are set twice in one statement."""
        seen: set[str] = set()
        for item in items:
            if item.name in seen:
                self._report(
                    place_of(item), f"the parameter `{item.name}` is set twice in one statement", code="SC210"
                )
            seen.add(item.name)
        return True

    def parameter_setting(self, name: int, value: ast.expr, place: Place) -> tree.ParamItem | None:
        text = self.string_name(name)
        if text is None:
            return None
        node = tree.ParamItem(name=text, value=value)
        self._put(node, place)
        return node

    def string_name(self, index: int) -> str | None:
        """A name written as a string."""
        value = self.string_value(index)
        if isinstance(value, str):
            return value
        self.fail(self.place_of_token(index), "a name cannot be bytes", help="remove the prefix `b`")
        return None

    def not_both(self, name: str | None, target: ast.expr | None) -> bool:
        if name is not None and target is not None:
            self.fail(
                place_of(target),
                "a record has either a name or a target, not both",
                help="remove `as` or `to`",
            )
            return False
        return True

    def probability(self, index: int) -> float:
        return float(self._texts[index].replace("_", ""))

    def is_probability(self, index: int) -> bool:
        """Report a probability outside 0 to 1."""
        value = self.number_value(index)
        if isinstance(value, complex) or not 0 <= value <= 1:
            self.fail(self.place_of_token(index), "a probability has to lie between 0 and 1")
            return False
        return True

    def is_requirement(self, condition: ast.expr) -> bool:
        """Refuse temporal operators where they have no meaning."""
        stack: list[ast.expr] = [condition]
        while stack:
            node = stack.pop()
            if isinstance(node, tree.Temporal):
                stack += node.operands
            elif isinstance(node, ast.BoolOp):
                stack += node.values
            elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
                stack.append(node.operand)
            elif not self._is_static(node):
                return False
        return True

    def _is_static(self, root: ast.expr) -> bool:
        stack: list[ast.AST] = [root]
        while stack:
            node = stack.pop()
            if isinstance(node, tree.Temporal):
                self.fail(
                    place_of(node),
                    f"`{node.operator}` cannot stand inside a conditional expression",
                    help="write the cases as `(c implies a) and (not c implies b)`",
                )
                return False
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id in ("always", "eventually", "next")
            ):
                self.fail(
                    place_of(node),
                    f"malformed use of the temporal operator `{node.func.id}`",
                    help="a temporal operator cannot be part of an ordinary expression",
                )
                return False
            for value in vars(node).values():
                if isinstance(value, ast.AST):
                    stack.append(value)
                elif type(value) is list:
                    stack += [each for each in value if isinstance(each, ast.AST)]
        return True

    # Calls and subscripts.

    def arguments(self, items: Sequence[Any]) -> tuple[list[Any], list[Any], Any] | None:
        """Split what a call is given into positional and keyword arguments, and check the order."""
        for item in items:
            kind = type(item)
            if kind is ast.keyword or kind is tuple:
                break
        else:
            return (items, [], None)  # type: ignore[return-value]
        if kind is tuple and len(items) == 1:
            return ([items[0][0]], [], items[0][0])
        positional: list[Any] = []
        keywords: list[Any] = []
        unpacked = False
        for item in items:
            kind = type(item)
            if kind is ast.keyword:
                keywords.append(item)
                unpacked = unpacked or item.arg is None
            elif kind is tuple:
                self.fail(place_of(item[0]), "a generator that is not the only argument needs parentheses")
                return None
            elif unpacked and kind is ast.Starred:
                self.fail(place_of(item), "an argument with `*` cannot follow one with `**`")
                return None
            elif keywords and kind is not ast.Starred:
                after = "an argument with `**`" if unpacked else "a keyword argument"
                self.fail(
                    place_of(item),
                    f"a positional argument cannot follow {after}",
                    help="move it to the front",
                )
                return None
            else:
                positional.append(item)
        return (positional, keywords, None)

    def generator_argument(
        self, element: ast.expr, parts: list[ast.comprehension], start: int, end: int
    ) -> tuple[ast.GeneratorExp]:
        """A generator in a call, from ``start`` to ``end``; if it is all, the call's parentheses are its own."""
        tokens = self._tokens
        node = ast.GeneratorExp(elt=element, generators=parts)
        self._put(
            node,
            (
                tokens.lines[start - 1],
                tokens.columns[start - 1],
                tokens.end_lines[end + 1],
                tokens.end_columns[end + 1],
            ),
        )
        return (node,)

    def one_subscript(self, node: ast.expr) -> ast.expr:
        """A lone subscript; one with a star is a tuple."""
        if type(node) is not ast.Starred:
            return node
        result = ast.Tuple(elts=[node], ctx=LOAD)
        self._put(result, place_of(node))
        return result

    def not_starred(self, node: ast.expr) -> ast.expr | None:
        if isinstance(node, ast.Starred):
            self.fail(place_of(node), "a starred expression cannot stand here")
            return None
        return node

    # Literals.

    def number_value(self, index: int) -> int | float | complex:
        try:
            return literals.number_value(self._texts[index])
        except literals.LiteralError as problem:
            self._report(self.place_of_token(index), str(problem), code="SC104")
            return 0

    def string_value(self, index: int) -> str | bytes:
        text = self._texts[index]
        if text[0] in "\"'" and "\\" not in text and text[:3] != '"""' and text[:3] != "'''":
            return text[1:-1]
        try:
            return literals.string_value(text)
        except literals.LiteralError as problem:
            self._report(self.place_of_token(index), str(problem), code="SC105")
            return text

    def string_kind(self, index: int) -> str | None:
        return "u" if self._texts[index][0] == "u" else None

    def strings(self, pieces: Sequence[Any], place: Place) -> ast.expr | None:
        """Adjacent strings and f-strings as one node."""
        return formatted.joined(self, self._tokens, pieces, place)

    def replacement_field(
        self,
        opening: int,
        value: ast.expr,
        equals: int | None,
        conversion: int | None,
        specification: tuple[int, list[Any]] | None,
        closing: int,
    ) -> list[ast.expr] | None:
        """The nodes of a replacement field of an f-string."""
        return formatted.replacement_field(
            self, self._tokens, opening, value, equals, conversion, specification, closing
        )

    def literal_problem(self, index: int, message: str) -> None:
        """Report an impossible literal."""
        self._report(self.place_of_token(index), message, code="SC105")

    # Patterns.

    def capture(self, index: int) -> str | None:
        text = self._texts[index]
        return None if text == "_" else text

    def capturable(self, index: int) -> bool:
        if self._texts[index] == "_":
            self.fail(self.place_of_token(index), "`_` cannot be the name of a pattern")
            return False
        return True

    def pattern_string(self, node: ast.expr) -> bool:
        if isinstance(node, ast.JoinedStr):
            self.fail(place_of(node), "an f-string cannot be a pattern")
            return False
        return True

    def is_complex(self, real: Any, imaginary: Any) -> bool:
        while isinstance(real, ast.UnaryOp):
            real = real.operand
        if isinstance(real.value, complex):
            self.fail(place_of(real), "a real number has to stand before the imaginary one")
            return False
        if not isinstance(imaginary.value, complex):
            self.fail(place_of(imaginary), "an imaginary number has to stand here")
            return False
        return True

    def not_starred_pattern(self, node: ast.pattern) -> ast.pattern | None:
        if isinstance(node, ast.MatchStar):
            self.fail(place_of(node), "a starred pattern has to be part of a sequence", help="add a comma")
            return None
        return node

    def class_pattern(
        self, cls: ast.expr, items: Sequence[Any] | None, place: Place
    ) -> ast.MatchClass | None:
        names: list[str] = []
        patterns: list[ast.pattern] = []
        keyword_patterns: list[ast.pattern] = []
        for name, pattern in items or ():
            if name is not None:
                names.append(name)
                keyword_patterns.append(pattern)
            elif names:
                self.fail(place_of(pattern), "a positional pattern cannot follow a keyword pattern")
                return None
            else:
                patterns.append(pattern)
        node = ast.MatchClass(cls=cls, patterns=patterns, kwd_attrs=names, kwd_patterns=keyword_patterns)
        self._put(node, place)
        return node

    def mapping_pattern(self, items: Sequence[Any], place: Place) -> ast.MatchMapping | None:
        rest = None
        keys: list[ast.expr] = []
        patterns: list[ast.pattern] = []
        for position, (key, pattern) in enumerate(items, start=1):
            if key is not None:
                keys.append(key)
                patterns.append(pattern)
            elif position < len(items):
                self.fail(self.place_of_token(pattern), "the rest, with `**`, has to stand last")
                return None
            else:
                rest = self._texts[pattern]
        node = ast.MatchMapping(keys=keys, patterns=patterns, rest=rest)
        self._put(node, place)
        return node


def _guard_word(statement: ast.stmt) -> str | None:
    if (
        isinstance(statement, ast.AnnAssign)
        and isinstance(statement.target, ast.Name)
        and statement.target.id in ("precondition", "invariant")
        and statement.value is None
    ):
        return statement.target.id
    return None


def _docstring(statement: ast.stmt) -> str | None:
    if (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    ):
        return statement.value.value
    return None


_DESCRIPTIONS: Final = {
    ast.Call: "a call",
    ast.BinOp: "an expression with an operator",
    ast.UnaryOp: "an expression with an operator",
    ast.BoolOp: "an expression with an operator",
    tree.Operation: "an expression with an operator",
    ast.Compare: "a comparison",
    ast.IfExp: "a conditional expression",
    ast.Lambda: "a lambda",
    ast.JoinedStr: "an f-string",
    ast.Dict: "a dictionary",
    ast.Set: "a set",
    ast.ListComp: "a comprehension",
    ast.SetComp: "a comprehension",
    ast.DictComp: "a comprehension",
    ast.GeneratorExp: "a generator",
    ast.Await: "an `await`",
    ast.Yield: "a `yield`",
    ast.YieldFrom: "a `yield`",
    ast.NamedExpr: "an assignment expression",
    ast.Tuple: "a tuple",
    ast.List: "a list",
    ast.Starred: "a starred expression",
    tree.New: "a new object",
}


def describe(node: ast.expr) -> str:
    """What an expression is, in words."""
    if isinstance(node, ast.Constant):
        if node.value is None or node.value is True or node.value is False:
            return f"`{node.value}`"
        return "`...`" if node.value is Ellipsis else "a literal"
    return _DESCRIPTIONS.get(type(node), "this expression")
