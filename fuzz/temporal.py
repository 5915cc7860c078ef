"""Conditions of `require` made from the grammar's temporal rules, and what must hold of each.

A formula is written in several ways: as the grammar derives it, laid out at random and on one line; with parentheses around the place of every operation in the tree; and as the table
of precedence alone predicts (`fuzz.climbing`). All of them are one tree, with one verdict on any finite trace
(`fuzz.traces`).

There are two varieties. In *propositions* the atoms are names, and so every tree is a formula. In *conditions* they are what
the ordinary ladder makes of names: comparisons, calls, operators of Scenic.
"""

import ast
import random
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, lru_cache, partial
from itertools import accumulate
from typing import Any, Final, NamedTuple

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from fuzz.climbing import TABLE, Climber, Table, Tree, climb
from fuzz.derivations import AlternativeId, Derivations, Option
from fuzz.draws import Draws, HypothesisDraws
from fuzz.grammar import Program, derivations
from fuzz.layout import lay_out
from fuzz.properties.case import Case, Property, Violation, describe
from fuzz.properties.differences import difference
from fuzz.terminals import FIXED, Piece, Shape
from fuzz.traces import Formula, State, atoms_of, conditional, formula_of, text_of, verdict
from grammar.generator import read_grammar_text
from grammar.generator.model import Gather, Item, Optional, Reference, Repeat, Token
from scenic.compiler import tree
from scenic.compiler.lowering import lower
from scenic.compiler.parser import parse
from scenic.compiler.precedence import Ladder
from scenic.compiler.resolver import resolve
from scenic.compiler.tokens import NEWLINE
from scenic.runtime.description.declarations import Closure, Required, required
from scenic.runtime.temporal.monitors import FormulaMonitor

__all__ = ["FORMULAS", "OF_FORMULAS", "formulas", "make_formula", "predicted", "texts", "written_in_full"]

_ROOT: Final = "temporal_expression"
_SCALE: Final = 120
"""Hypothesis prefers small numbers where there are more than 127."""
_MANY: Final = 20
_LAYOUTS: Final = 1 << 16
_TEMPORAL: Final = 5.0
"""Weight of a temporal operator, compared with an operator of the ordinary ladder."""
_TRACES: Final = 8
_LONGEST: Final = 5
_OFTEN: Final = (0.1, 0.5, 0.8, 0.9)
"""Temporal operators that are about more than one state."""

_COMMON: Final = """
@start temporal_expression

# Temporal operators have no meaning inside a conditional expression.
temporal_expression__IfExp: disjunction 'if' disjunction 'else' expression
"""

_PROPOSITIONS: Final = f"""{_COMMON}
temporal_expression__lambda_expression: disjunction
expression__lambda_expression: disjunction
temporal_not__1: PROPOSITION
temporal_not__4: PROPOSITION
inversion__1: PROPOSITION
inversion__3: PROPOSITION
"""

_CONDITIONS: Final = f"""{_COMMON}
lambda_expression__1: 'lambda' ':' expression
temporal_not__1: 'not' "visible" prefix
inversion__1: 'not' "visible" prefix

# The table knows operators, no displays and no specifiers, and one expression stands for all that may be in brackets.
atom__1: PROPOSITION
atom__2: PROPOSITION
atom__3: PROPOSITION
atom__4: PROPOSITION
atom__5: '(' expression ')'
atom__6: PROPOSITION
atom__7: PROPOSITION
atom__8: PROPOSITION
atom__9: PROPOSITION
atom__10: PROPOSITION
atom__11: PROPOSITION
power__3: awaited
primary__1: primary '.' PROPERTY
primary__3: primary '(' expression ')'
primary__4: primary '[' expression ']'

# One operator of each shape. The word that closes an operand must not be taken by an operator within it.
prefix__1: operation
operation:
    | "visible" prefix
    | 'not' "visible" prefix
    | "distance" 'from' prefix
    | "distance" 'from' primary 'to' prefix
    | "relative" "heading" 'of' primary 'from' prefix
    | "front" 'of' prefix
bitxor__2: bitxor "offset" "along" primary 'by' bitand
"""

_NAMES: Final[Mapping[str, tuple[str, ...]]] = {
    "PROPOSITION": ("a", "b", "c"),
    "PROPERTY": ("m", "n"),
}
"""The names that atoms are made of, by their kinds."""


class Variety:
    """One kind of formulas: the temporal rules with a narrowing of their own.

    ``depth`` is how many expansions there are within each other, not counting what a rule needs at least, and
    ``expansions`` how many before only the shortest ones are used. A rule is expanded in its shortest way with the
    probability ``leaves``, where there are others.
    """

    def __init__(self, narrowing: str, *, depth: int, expansions: int, leaves: float) -> None:
        self.derivations = Derivations(derivations().grammar, read_grammar_text(narrowing, digest=""))
        self._depth = depth
        self._expansions = expansions
        self._leaves = leaves
        self._tables: dict[tuple[str, int], tuple[Sequence[Option], list[float]]] = {}

    def make(self, draws: Draws) -> tuple[list[Piece], set[AlternativeId]]:
        """Return a formula, and the alternatives of the grammar that it uses."""
        maker = _Maker(self, draws, self._expansions)
        maker.expand(_ROOT, self.derivations.height(_ROOT) + self._depth)
        return maker.pieces, maker.alternatives

    def choose(self, rule: str, depth: int, share: float) -> Option:
        """Return the option of a rule that a number from 0 to 1 means, the simplest first, among those that fit into a depth."""
        depth = max(depth, self.derivations.options[rule][0].height)
        if (rule, depth) not in self._tables:
            fitting = [option for option in self.derivations.options[rule] if option.height <= depth]
            weights = [
                _TEMPORAL if option.rule.startswith("temporal") else 1.0
                for option in fitting
                if option.height > fitting[0].height
            ]
            lowest = len(fitting) - len(weights)
            leaf = self._leaves * sum(weights) / (1 - self._leaves) / lowest if weights else 1.0
            self._tables[rule, depth] = fitting, list(accumulate([leaf] * lowest + weights))
        options, table = self._tables[rule, depth]
        return options[bisect_right(table, share * table[-1])]


class _Maker:
    """A formula that is being made, from left to right."""

    def __init__(self, variety: Variety, draws: Draws, expansions: int) -> None:
        self.pieces: list[Piece] = []
        self.alternatives: set[AlternativeId] = set()
        self._variety = variety
        self._draws = draws
        self._remaining = expansions
        self._depth = 0

    def expand(self, rule: str, depth: int) -> None:
        """Make what a rule derives, not deeper than ``depth`` unless the rule needs more."""
        self._depth = depth
        self._expand(rule)

    def _expand(self, rule: str) -> None:
        depth = self._depth if self._remaining > 0 else 0
        self._remaining -= 1
        option = self._variety.choose(rule, depth, self._share(rule))
        self.alternatives.update(option.counts_as)
        for item in option.items:
            self._emit(item, depth - 1)

    def _share(self, rule: str) -> float:
        """A number from 0 to 1, as fine as the number of options requires."""
        count = len(self._variety.derivations.options[rule])
        if count == 1:
            return 0.0
        share = self._draws.number(_SCALE) / _SCALE
        return share + self._draws.number(_SCALE) / _SCALE**2 if count > _MANY else share

    def _emit(self, item: Item, depth: int) -> None:
        match item:
            case Token(literal=True):
                self._piece(item.text)
            case Token(text=kind) | Reference(rule=kind) if kind in _NAMES:
                self._piece(_NAMES[kind][self._draws.number(len(_NAMES[kind]))])
            case Reference():
                self._depth = depth
                self._draws.part(self._expand, item.rule)
            case Optional():
                if self._draws.number(2) and self._remaining > 0:
                    self._emit(item.item, depth)
            case Repeat(at_least_one=True):
                self._emit(item.item, depth)
                # Chains of three are there for the links of one level; longer ones show nothing new.
                while self._draws.number(4) == 3 and self._remaining > 0:
                    self._emit(item.item, depth)
            case Gather():
                self._emit(item.item, depth)
            case _:
                raise AssertionError(f"the temporal rules have no {item}")

    def _piece(self, text: str) -> None:
        self.pieces.append(Piece(text, Shape.WORD if text.isidentifier() else Shape.OPERATOR))


@cache
def varieties() -> tuple[Variety, Variety]:
    """Return propositions and conditions, made from the grammar once."""
    return (
        Variety(_PROPOSITIONS, depth=9, expansions=30, leaves=0.25),
        Variety(_CONDITIONS, depth=9, expansions=35, leaves=0.3),
    )


def make_formula(draws: Draws, variety: int | None = None) -> Program:
    """A program of one `require`, made from the numbers of ``draws``; by default of either variety."""
    index = draws.number(len(varieties())) if variety is None else variety
    formula, alternatives = varieties()[index].make(draws)
    pieces = (Piece("require", Shape.WORD), *formula, FIXED["NEWLINE"])
    seed = draws.number(_LAYOUTS)
    return Program(lay_out(pieces, seed=seed), pieces, frozenset(alternatives))


def formulas(variety: int | None = None) -> SearchStrategy[Program]:
    """Return a strategy of the formulas that `make_formula` makes."""

    @st.composite
    def formula(draw: DrawFn) -> Program:
        return make_formula(HypothesisDraws(draw), variety)

    return formula()


FORMULAS: Final[SearchStrategy[Program]] = formulas()
"""Formulas of both varieties."""


# Texts.


def words_of(case: Case) -> list[str]:
    """Return the tokens of the condition."""
    return [
        text
        for kind, text in zip(case.tokens.kinds[1:], case.tokens.texts[1:], strict=True)
        if kind != NEWLINE and text
    ]


def condition_of(text: str) -> ast.expr:
    """Return the condition of a program of one `require`.

    Raises `Violation` if there is anything wrong with it.
    """
    result = parse(text)
    for diagnostic in result.diagnostics:
        raise Violation(f"refused: {describe(diagnostic)}\n{text}")
    match result.tree.body:
        case [tree.Require(condition=condition)]:
            return condition
    raise Violation(f"something else than one requirement: {text}")


def written_in_full(line: str, node: ast.expr) -> str:
    """A line of ASCII text with parentheses around the place of each operation in the tree of its condition."""
    inserted: list[str] = [""] * (len(line) + 1)
    for each in ast.walk(node):
        if isinstance(each, ast.expr) and not isinstance(each, ast.Name | ast.Constant):
            if each.end_col_offset is None:
                raise Violation(f"no place: {ast.dump(each)}")
            inserted[each.col_offset] += "("
            inserted[each.end_col_offset] = ")" + inserted[each.end_col_offset]
    return "".join(before + character for before, character in zip(inserted, [*line, ""], strict=True))


def predicted(words: Sequence[str], table: Table = TABLE) -> str | None:
    """Return the condition of the tokens ``words`` as a table of precedence predicts it, with parentheses around every operation.

    ``None`` if the table says that it is refused.
    """
    return climb(" ".join(words), temporal=True, table=table)


class Reading(NamedTuple):
    """One way to write a formula: what it is called, the program, and its condition."""

    name: str
    text: str
    condition: ast.expr


@lru_cache(maxsize=1)
def readings(case: Case) -> tuple[Reading, ...]:
    """All ways to write the formula of a case.

    Raises `Violation` if one of them is refused.
    """
    words = words_of(case)
    plain = f"require {' '.join(words)}"
    condition = condition_of(plain)
    full = predicted(words)
    if full is None:
        raise Violation("the table of precedence refuses it")
    texts = {
        "in full": written_in_full(plain, condition),
        "as the table predicts": f"require {full}",
    }
    return (
        Reading("as the grammar derives it", case.text, condition_of(case.text)),
        Reading("on one line", plain, condition),
        *(Reading(name, text, condition_of(text)) for name, text in texts.items()),
    )


def texts(case: Case) -> Mapping[str, str]:
    """Return the texts of `readings`, by what they are called."""
    return {name: text for name, text, _ in readings(case)}


def random_traces(number: int, atoms: Sequence[str]) -> Iterator[list[State]]:
    """Some finite traces over atoms, which depend on a number alone."""
    chance = random.Random(number)
    for _ in range(_TRACES):
        # Where an atom nearly always holds, what is said of all states differs from what is said of one.
        often = {atom: chance.choice(_OFTEN) for atom in atoms}
        yield [
            frozenset(atom for atom in atoms if chance.random() < often[atom])
            for _ in range(chance.randint(1, _LONGEST))
        ]


# Properties.


def formulas_are_accepted(case: Case) -> None:
    """The parser finds nothing wrong with what the temporal rules derive."""
    condition_of(case.text)


def all_texts_are_one_tree(case: Case) -> None:
    """However a formula is written, its tree is the same."""
    first, *others = readings(case)
    for name, text, condition in others:
        where = difference(first.condition, condition)
        if where is not None:
            raise Violation(f"another tree {name}: {where}\n{text}")


def all_texts_have_one_verdict(case: Case) -> None:
    """However a formula is written, its verdict on a finite trace is the same."""
    read = {name: formula_of(condition, atom=ast.dump) for name, _, condition in readings(case)}
    reference_formula = read["in full"]
    atoms = sorted(atoms_of(reference_formula))
    for trace in random_traces(case.number, atoms):
        reference_verdict = verdict(reference_formula, trace)
        for name, formula in read.items():
            verdict_here = verdict(formula, trace)
            if verdict_here is not reference_verdict:
                raise Violation(f"{verdict_here.name} {name}, {reference_verdict.name} in full, on {trace}")


def the_table_alone_gives_the_verdict(case: Case) -> None:
    """The tree that the table of precedence predicts, which no parser of ours made, has the verdict of the parser's."""
    climbed_tree = Climber(" ".join(words_of(case))).whole(Ladder.TEMPORAL)
    if climbed_tree is None:
        raise Violation("the table of precedence refuses it")
    condition = condition_of(case.text)
    if not _is_propositional(condition):
        return
    expected_formula, parser_formula = _formula_of_climbed(climbed_tree), formula_of(condition)
    for trace in random_traces(case.number, sorted(atoms_of(expected_formula))):
        if verdict(parser_formula, trace) is not verdict(expected_formula, trace):
            raise Violation(f"{text_of(parser_formula)} is not {text_of(expected_formula)} on {trace}")


def formulas_are_followed_as_meant(case: Case) -> None:
    """A simulation follows the compiled code of a formula to the same verdict as the formula, on any trace."""
    condition = condition_of(case.text)
    if not _is_propositional(condition):
        return
    formula = formula_of(condition)
    module = lower(case.result.tree, resolve(case.result.tree, case.source))
    prelude = _Prelude()
    names = sorted(atoms_of(formula))
    scope: dict[str, Any] = {**dict.fromkeys(names, False), "__scenic__": prelude}
    exec(compile(module, "<fuzz>", "exec"), scope)
    requirement = required(prelude.required, "", None, None)
    for trace in random_traces(case.number, names):
        monitor = FormulaMonitor(requirement.formula)
        for state in trace:
            # Nothing in the text binds the names, so that the code reads them when it is called.
            scope.update((name, name in state) for name in names)
            monitor.add(partial(_holds, requirement))
        expected_verdict = verdict(formula, trace)
        if monitor.verdict is None or monitor.verdict.name != expected_verdict.name:
            raise Violation(f"simulations find {monitor.verdict}, not {expected_verdict}, on {trace}")


def _holds(followed: Required, index: int) -> bool:
    return bool(followed.atoms[index]())


class _Prelude:
    """The functions that the code of requirements calls; it stores the formula."""

    def __init__(self) -> None:
        self.required: Any = None

    def require(self, condition: object, **_: object) -> None:
        self.required = condition

    def condition(
        self, traced: object, concrete: Callable[..., bool], values: Sequence[bool], *_margin: object
    ) -> Closure:
        del traced  # It builds nodes for the same value.
        return Closure(concrete, values)

    def conjunction(self, *parts: object) -> object:
        return ("and", *parts)

    def disjunction(self, *parts: object) -> object:
        return ("or", *parts)

    def negation(self, part: object) -> object:
        return ("not", part)

    def temporal(self, operator: str, *parts: object) -> object:
        return (operator, *parts)


def _is_propositional(condition: ast.expr) -> bool:
    """Return whether all atoms are names."""
    try:
        formula_of(condition)
    except ValueError:
        return False
    return True


def _formula_of_climbed(climbed: Tree) -> Formula:
    """The formula of a tree of the climbing parser whose atoms are names."""
    if isinstance(climbed, str):
        return climbed
    form, parts = climbed
    operands = [
        _formula_of_climbed(part) for part in parts if not (isinstance(part, str) and part in form.words)
    ]
    if form.node == "IfExp":
        yes, test, no = operands
        return conditional(yes, test, no)
    return (form.words[0], *operands)


OF_FORMULAS: Final[tuple[Property, ...]] = (
    *map(
        Property.of,
        (
            formulas_are_accepted,
            all_texts_are_one_tree,
            all_texts_have_one_verdict,
            the_table_alone_gives_the_verdict,
            formulas_are_followed_as_meant,
        ),
    ),
)
"""Properties of every formula that the temporal rules derive."""
