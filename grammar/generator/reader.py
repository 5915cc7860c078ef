"""Reads a grammar file, with pegen's reader of its notation, into `grammar.generator.model`."""

import ast
import io
import tokenize
from collections.abc import Iterable
from pathlib import Path

from pegen import grammar as notation
from pegen.grammar_parser import GeneratedParser
from pegen.tokenizer import Tokenizer

from grammar.digest import grammar_digest
from grammar.generator.model import (
    FIRST_WORD_KIND,
    KINDS,
    NAME,
    Alternative,
    BlockEnded,
    Cut,
    Gather,
    Grammar,
    GrammarError,
    Item,
    Look,
    Named,
    Optional,
    Reference,
    Repeat,
    Rule,
    Token,
    TokenChoice,
    Vocabulary,
)


def read_grammar(path: Path) -> Grammar:
    """Read the grammar file at ``path``.

    Raises `GrammarError` if it is not in pegen's notation, defines a rule twice or uses something that the
    generator does not know.
    """
    return read_grammar_text(path.read_text(encoding="utf-8"), digest=grammar_digest(path))


def read_grammar_text(text: str, *, digest: str = "", replacing: bool = False) -> Grammar:
    """Read a grammar from its text; as `read_grammar`. With ``replacing`` a later rule stands in place of one of its name, and all words
    in capitals are kinds of tokens.
    """
    parser = GeneratedParser(Tokenizer(tokenize.generate_tokens(io.StringIO(text).readline)))
    # Not `parser.start()`: the Grammar object that it makes keeps only the last of several rules of one name.
    metas = parser.metas() or []
    rules = parser.rules()
    if not rules or parser.expect("ENDMARKER") is None:
        last = parser._tokenizer.diagnose()
        raise GrammarError(f"line {last.start[0]}: this is not pegen's notation: {last.line.strip()!r}")
    settings: dict[str, list[str]] = {}
    for name, value in metas:
        settings.setdefault(name, []).append(value or "")
    unknown_settings = settings.keys() - {"start", "recover"}
    if unknown_settings or len(settings.get("start", [])) != 1:
        raise GrammarError(f"expected one `@start` and any `@recover`; unknown: {sorted(unknown_settings)}")
    if replacing:
        rules = list({rule.name: rule for rule in rules}.values())
    return _Reader(any_kinds=replacing).grammar(rules, settings, digest)


class _Reader:
    """Turns pegen's objects into ours."""

    def __init__(self, *, any_kinds: bool) -> None:
        self.any_kinds = any_kinds
        self.rules: dict[str, Rule] = {}
        self.groups: dict[tuple[Alternative, ...], str] = {}
        self.hard: set[str] = set()
        self.soft: set[str] = set()

    def grammar(self, rules: Iterable[notation.Rule], settings: dict[str, list[str]], digest: str) -> Grammar:
        for rule in rules:
            if rule.name in self.rules:
                raise GrammarError(f"rule {rule.name!r} is defined twice")
            if rule.name in KINDS or rule.name == "BLOCK_ENDED" or rule.name.startswith("group_"):
                raise GrammarError(f"rule {rule.name!r}: the name belongs to the generator")
            label = None if rule.type is None else str(ast.literal_eval(rule.type))
            # Entered before its groups, so that rules stand in the order of the file.
            self.rules[rule.name] = Rule(rule.name, (), label)
            self.rules[rule.name] = Rule(rule.name, self.alternatives(rule.rhs), label, rule.memo)
        if both := self.hard & self.soft:
            raise GrammarError(f"both hard and soft keywords: {sorted(both)}")
        return Grammar(
            self.rules,
            settings["start"][0],
            frozenset(settings.get("recover", ())),
            self.vocabulary(),
            digest,
        )

    def vocabulary(self) -> Vocabulary:
        keywords = sorted(word for word in self.hard if word.isidentifier())
        operators = sorted(self.hard.difference(keywords))
        numbered = {word: kind for kind, word in enumerate(keywords + operators, FIRST_WORD_KIND)}
        return Vocabulary(
            {word: numbered[word] for word in keywords},
            {word: numbered[word] for word in operators},
            {word: kind for kind, word in enumerate(sorted(self.soft), NAME + 1)},
        )

    def alternatives(self, rhs: notation.Rhs) -> tuple[Alternative, ...]:
        return tuple(
            Alternative(tuple(self.named(item) for item in alternative.items), alternative.action)
            for alternative in rhs.alts
        )

    def named(self, item: notation.NamedItem) -> Named:
        return Named(self.item(item.item), item.name)

    def item(self, node: object) -> Item:
        match node:
            case notation.StringLeaf():
                return self.literal(node.value)
            case notation.NameLeaf(value="BLOCK_ENDED"):
                return BlockEnded()
            case notation.NameLeaf():
                is_kind = node.value in KINDS or (self.any_kinds and node.value.isupper())
                return Token(node.value, literal=False) if is_kind else Reference(node.value)
            case notation.Group():
                return self.group(node.rhs)
            case notation.Rhs():  # what stands in square brackets
                return self.group(node)
            case notation.Opt():
                return Optional(self.item(node.node))
            case notation.Gather():
                return Gather(self.item(node.separator), self.item(node.node))
            case notation.Repeat0():
                return Repeat(self.item(node.node), at_least_one=False)
            case notation.Repeat1():
                return Repeat(self.item(node.node), at_least_one=True)
            case notation.PositiveLookahead():
                return Look(self.looked_at(node.node), positive=True)
            case notation.NegativeLookahead():
                return Look(self.looked_at(node.node), positive=False)
            case notation.Cut():
                return Cut()
            case _:
                raise GrammarError(f"{type(node).__name__} is not supported: {node}")

    def literal(self, quoted: str) -> Token:
        soft = quoted.startswith('"')
        text = str(ast.literal_eval(quoted))
        if soft and not text.isidentifier():
            raise GrammarError(f"{quoted}: only words can be soft keywords")
        (self.soft if soft else self.hard).add(text)
        return Token(text, literal=True, soft=soft)

    def looked_at(self, node: object) -> Item:
        """The item of a lookahead, whose value nobody needs."""
        if isinstance(node, notation.Group):
            for alternative in node.rhs.alts:
                if len(alternative.items) > 1 and alternative.action is None:
                    alternative.action = "True"
        return self.item(node)

    def group(self, rhs: notation.Rhs) -> Item:
        alternatives = self.alternatives(rhs)
        bare = [
            alternative.items[0].item
            for alternative in alternatives
            if len(alternative.items) == 1 and alternative.action is None
        ]
        if len(bare) == len(alternatives):
            if len(bare) == 1:
                return bare[0]
            tokens = [item for item in bare if isinstance(item, Token)]
            if len(tokens) == len(bare):
                return TokenChoice(tuple(tokens))
        # Equal groups are one rule.
        name = self.groups.setdefault(alternatives, f"group_{len(self.groups) + 1}")
        self.rules[name] = Rule(name, alternatives, lifted=True)
        return Reference(name)
