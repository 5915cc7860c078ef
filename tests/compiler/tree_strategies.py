"""Trees made directly, not from text: random ones, and every operator in every operand of every other."""

import ast
from collections.abc import Iterator, Sequence
from typing import Any, Final

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from scenic.compiler import tree
from scenic.compiler.generated import SOFT_KEYWORDS
from scenic.compiler.precedence import FORMS, SPECIFIERS, Form, Ladder

LOAD: Final = ast.Load()


def name(text: str) -> ast.Name:
    return ast.Name(id=text, ctx=LOAD)


def parameters(**fields: Any) -> ast.arguments:
    empty = {"posonlyargs": [], "args": [], "kwonlyargs": [], "kw_defaults": [], "defaults": []}
    return ast.arguments(**{"vararg": None, "kwarg": None, **empty, **fields})


def specifier(form: Form, operands: Sequence[ast.expr]) -> tree.SpecifierPhrase:
    """A specifier with as many of ``operands`` as it takes."""
    slots = [slot.target.index for slot in form.slots if slot.target is not None]
    found: list[ast.expr | None] = [None] * (len(slots) + len(form.absent))
    for index, operand in zip(slots, operands, strict=False):
        found[index or 0] = operand
    given = "heading" if form.operator == "with" else None
    return tree.SpecifierPhrase(specifier=form.operator, property=given, operands=found)


def build(form: Form, operands: Sequence[ast.expr]) -> ast.expr:
    """The node of a form with operands; instances have one of each specifier with the operand."""
    first = operands[0]
    operator: Any = form.operator and getattr(ast, form.operator, None)
    match form.node:
        case "NamedExpr":
            return ast.NamedExpr(target=name("n"), value=first)
        case "IfExp":
            return ast.IfExp(body=first, test=operands[1], orelse=operands[2])
        case "Lambda":
            return ast.Lambda(args=parameters(), body=first)
        case "BoolOp":
            return ast.BoolOp(op=operator(), values=list(operands))
        case "UnaryOp":
            return ast.UnaryOp(op=operator(), operand=first)
        case "BinOp":
            return ast.BinOp(left=first, op=operator(), right=operands[1])
        case "Compare":
            return ast.Compare(left=first, ops=[operator()], comparators=[operands[1]])
        case "Await":
            return ast.Await(value=first)
        case "Attribute":
            return ast.Attribute(value=first, attr="a", ctx=LOAD)
        case "Subscript":
            return ast.Subscript(value=first, slice=name("i"), ctx=LOAD)
        case "Call":
            arguments = [name("i")] if len(form.parts) > 3 else []
            return ast.Call(func=first, args=arguments, keywords=[])
        case "Temporal":
            return tree.Temporal(operator=form.operator, operands=list(operands))
        case "Operation":
            slots = [slot.target.index for slot in form.slots if slot.target is not None]
            found: list[ast.expr | None] = [None] * (len(slots) + len(form.absent))
            for index, operand in zip(slots, operands, strict=True):
                found[index or 0] = operand
            return tree.Operation(operator=form.operator, operands=found)
    raise AssertionError(form)


ORDINARY: Final = tuple(form for form in FORMS if form.ladder is Ladder.ORDINARY and form.slots and form.node)
TEMPORAL: Final = tuple(form for form in FORMS if form.ladder is Ladder.TEMPORAL and form.node)


def instances() -> Iterator[tree.New]:
    """An instance with every specifier, and one without."""
    yield tree.New(cls=name("C"), specifiers=[])
    for form in SPECIFIERS:
        operands = [name(f"s{index}") for index in range(len(form.slots))]
        yield tree.New(cls=name("C"), specifiers=[specifier(form, operands)])


def simple() -> list[ast.expr]:
    """Every operator with names as operands, every instance, and the atom that is an operator."""
    found: list[ast.expr] = [build(form, [name(x) for x in "xyz"[: len(form.slots)]]) for form in ORDINARY]
    return [*found, *instances(), tree.Operation(operator="initial scenario", operands=[])]


def with_operand(form: Form, place: int, operand: ast.expr) -> ast.expr:
    operands: list[ast.expr] = [name(x) for x in "abc"[: len(form.slots)]]
    operands[place] = operand
    return build(form, operands)


def pairs(outer: Sequence[Form], inner: Sequence[ast.expr]) -> Iterator[ast.expr]:
    """Every one of ``inner`` in every operand of ``outer``."""
    for form in outer:
        for place in range(len(form.slots)):
            for operand in inner:
                yield with_operand(form, place, operand)


def in_specifiers(inner: Sequence[ast.expr]) -> Iterator[ast.expr]:
    """Every one of ``inner`` in every operand of every specifier, last and before another one."""
    for form in SPECIFIERS:
        for place in range(len(form.slots)):
            for operand in inner:
                operands: list[ast.expr] = [name(x) for x in "abc"[: len(form.slots)]]
                operands[place] = operand
                last = tree.SpecifierPhrase(specifier="on", property=None, operands=[name("o")])
                yield tree.New(cls=name("C"), specifiers=[specifier(form, operands)])
                yield tree.New(cls=name("C"), specifiers=[specifier(form, operands), last])


# Random trees.

_WORDS: Final = ("a", "b", "xs", *(word for word in SOFT_KEYWORDS if word != "_"))
names: Final = st.sampled_from(_WORDS).map(name)
texts: Final = st.text(max_size=6) | st.text("'\"\\{}\n\t\r\ud800é\x00 aN", max_size=8)
constants: Final[SearchStrategy[ast.expr]] = st.one_of(
    st.sampled_from([None, True, False, ...]),
    st.integers(0, 10**30),
    st.floats(min_value=0, allow_nan=False).map(abs),
    st.floats(min_value=0, allow_nan=False).map(lambda value: complex(0, abs(value))),
    texts,
    st.binary(max_size=5),
).map(lambda value: ast.Constant(value=value, kind=None))


@st.composite
def _joined(draw: DrawFn, inner: SearchStrategy[ast.expr], depth: int = 1) -> ast.JoinedStr:
    values: list[ast.expr] = []
    for _ in range(draw(st.integers(0, 3))):
        text = draw(texts)
        if text and not (values and isinstance(values[-1], ast.Constant)):
            values.append(ast.Constant(value=text, kind=None))
        else:
            specification = draw(_joined(inner, depth - 1)) if depth and draw(st.booleans()) else None
            conversion = draw(st.sampled_from([-1, ord("r"), ord("s"), ord("a")]))
            values.append(
                ast.FormattedValue(value=draw(inner), conversion=conversion, format_spec=specification)
            )
    return ast.JoinedStr(values=values)


@st.composite
def _comprehension(draw: DrawFn, inner: SearchStrategy[ast.expr]) -> ast.expr:
    loops = [
        ast.comprehension(
            target=draw(names),
            iter=draw(inner),
            ifs=draw(st.lists(inner, max_size=2)),
            is_async=draw(st.integers(0, 1)),
        )
        for _ in range(draw(st.integers(1, 2)))
    ]
    kind = draw(st.sampled_from([ast.ListComp, ast.SetComp, ast.GeneratorExp, None]))
    if kind is None:
        return ast.DictComp(key=draw(inner), value=draw(inner), generators=loops)
    return kind(elt=draw(inner), generators=loops)


@st.composite
def _collection(draw: DrawFn, inner: SearchStrategy[ast.expr]) -> ast.expr:
    elements = draw(st.lists(inner | inner.map(_starred), max_size=3))
    kind = draw(st.sampled_from([ast.List, ast.Tuple, ast.Set]))
    if kind is ast.Set:
        return ast.Set(elts=elements or [draw(inner)])
    return kind(elts=elements, ctx=LOAD)


def _starred(node: ast.expr) -> ast.expr:
    return ast.Starred(value=node, ctx=LOAD)


@st.composite
def _call(draw: DrawFn, inner: SearchStrategy[ast.expr]) -> ast.expr:
    arguments = draw(st.lists(inner | inner.map(_starred), max_size=3))
    keywords = [
        ast.keyword(arg=draw(st.sampled_from(_WORDS)), value=value)
        for value in draw(st.lists(inner, max_size=2))
    ]
    if draw(st.booleans()):
        keywords.append(ast.keyword(arg=None, value=draw(inner)))
    return ast.Call(func=draw(inner), args=arguments, keywords=keywords)


@st.composite
def _subscript(draw: DrawFn, inner: SearchStrategy[ast.expr]) -> ast.expr:
    optional = st.none() | inner
    part = inner | st.builds(ast.Slice, lower=optional, upper=optional, step=optional)
    index = draw(part | st.lists(part, min_size=1, max_size=3).map(lambda x: ast.Tuple(elts=x, ctx=LOAD)))
    return ast.Subscript(value=draw(inner), slice=index, ctx=LOAD)


@st.composite
def _lambda(draw: DrawFn, inner: SearchStrategy[ast.expr]) -> ast.expr:
    words = draw(st.lists(st.sampled_from(_WORDS), max_size=6, unique=True))
    kinds = [draw(st.integers(0, 2)) for _ in words]
    of_kind = [
        [ast.arg(arg=word, annotation=None) for word, kind in zip(words, kinds, strict=True) if kind == each]
        for each in range(3)
    ]
    positional = len(of_kind[0]) + len(of_kind[1])
    return ast.Lambda(
        args=parameters(
            posonlyargs=of_kind[0],
            args=of_kind[1],
            kwonlyargs=of_kind[2],
            defaults=[draw(inner) for _ in range(draw(st.integers(0, positional)))],
            kw_defaults=[draw(st.none() | inner) for _ in of_kind[2]],
            vararg=draw(st.none() | st.just(ast.arg(arg="rest", annotation=None))),
            kwarg=draw(st.none() | st.just(ast.arg(arg="others", annotation=None))),
        ),
        body=draw(inner),
    )


@st.composite
def _operator(draw: DrawFn, inner: SearchStrategy[ast.expr]) -> ast.expr:
    form = draw(st.sampled_from(ORDINARY))
    return build(form, [draw(inner) for _ in form.slots])


@st.composite
def _specifiers(draw: DrawFn, inner: SearchStrategy[ast.expr], least: int = 0) -> list[tree.SpecifierPhrase]:
    forms = draw(st.lists(st.sampled_from(SPECIFIERS), min_size=least, max_size=2))
    return [specifier(form, [draw(inner) for _ in form.slots]) for form in forms]


def _larger(inner: SearchStrategy[ast.expr]) -> SearchStrategy[ast.expr]:
    return st.one_of(
        _operator(inner),
        _operator(inner),
        st.builds(tree.New, cls=names, specifiers=_specifiers(inner)),
        _call(inner),
        _collection(inner),
        _comprehension(inner),
        _subscript(inner),
        _lambda(inner),
        _joined(inner),
        st.builds(ast.Yield, value=st.none() | inner),
        st.builds(ast.YieldFrom, value=inner),
        st.lists(st.tuples(st.none() | inner, inner), max_size=2).map(
            lambda items: ast.Dict(keys=[key for key, _ in items], values=[value for _, value in items])
        ),
    )


expressions: Final = st.recursive(names | constants, _larger, max_leaves=8)


@st.composite
def _condition(draw: DrawFn, inner: SearchStrategy[ast.expr]) -> ast.expr:
    form = draw(st.sampled_from([form for form in TEMPORAL if form.node != "Lambda"]))
    return build(form, [draw(inner) for _ in form.slots])


conditions: Final = st.recursive(names | expressions, _condition, max_leaves=6)
"""Conditions of `require`."""


@st.composite
def _duration(draw: DrawFn) -> tree.Duration:
    return tree.Duration(value=draw(expressions), unit=draw(st.sampled_from(["seconds", "steps"])))


_optional: Final = st.none() | expressions
_title: Final = st.none() | st.sampled_from(["n", "7", "two words", "to"])
_some: Final = st.lists(expressions, min_size=1, max_size=3)
_block: Final = st.just([ast.Pass()])

statements: Final[SearchStrategy[ast.stmt]] = st.one_of(
    st.builds(ast.Expr, value=expressions | expressions.map(_starred)),
    st.builds(
        ast.Assign,
        targets=st.lists(names, min_size=1, max_size=2),
        value=expressions,
        type_comment=st.none(),
    ),
    st.builds(ast.AugAssign, target=names, op=st.just(ast.Add()), value=expressions),
    st.builds(ast.AnnAssign, target=names, annotation=expressions, value=_optional, simple=st.integers(0, 1)),
    st.builds(ast.Return, value=_optional),
    st.builds(ast.Raise, exc=expressions, cause=_optional),
    st.builds(ast.Assert, test=expressions, msg=_optional),
    st.builds(ast.If, test=expressions, body=_block, orelse=st.just([])),
    st.builds(
        ast.With,
        items=st.lists(
            st.builds(ast.withitem, context_expr=expressions, optional_vars=st.none() | names),
            min_size=1,
            max_size=2,
        ),
        body=_block,
        type_comment=st.none(),
    ),
    st.builds(
        ast.For, target=names, iter=expressions, body=_block, orelse=st.just([]), type_comment=st.none()
    ),
    st.builds(tree.Require, condition=conditions, probability=st.none() | st.just(0.5), name=_title),
    st.builds(tree.RequireMonitor, monitor=expressions, name=_title),
    st.builds(
        tree.Record,
        moment=st.none(),
        value=expressions,
        every=st.none() | _duration(),
        after=st.none() | _duration(),
        name=st.none(),
        to=_optional,
    ),
    st.builds(
        tree.Record,
        moment=st.sampled_from(["initial", "final"]),
        value=expressions,
        every=st.none(),
        after=st.none(),
        name=_title,
        to=st.none(),
    ),
    st.builds(tree.Take, actions=_some),
    st.builds(tree.Do, targets=_some, duration=st.none(), until=_optional),
    st.builds(tree.Do, targets=_some, duration=_duration(), until=st.none()),
    st.builds(tree.DoChoose, targets=_some),
    st.builds(tree.DoShuffle, targets=_some),
    st.builds(tree.Simulator, value=expressions),
    st.builds(tree.Mutate, targets=st.lists(names, max_size=2), scale=_optional),
    st.builds(tree.WaitFor, duration=_duration()),
    st.builds(tree.WaitUntil, condition=expressions),
    st.builds(tree.TerminateWhen, simulation=st.booleans(), condition=expressions, name=_title),
    st.builds(tree.Override, target=expressions, specifiers=_specifiers(expressions, 1)),
    st.builds(
        tree.Param,
        items=st.lists(
            st.builds(
                tree.ParamItem, name=st.sampled_from(["a", "by", "two words", "visible"]), value=expressions
            ),
            min_size=1,
            max_size=2,
        ),
    ),
)
"""Statements without blocks of interest."""
