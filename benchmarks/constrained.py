"""Judges the grammars for constrained decoding by two engines: ``python -m benchmarks.constrained [--engine NAME] [--sentences N]``.

For each engine: the size of the grammar and the time to compile it; the shares of programs and sentences of the fuzzer that it accepts; of
mutants that the parser refuses, the share that it refuses, too; and the share of texts sampled under the grammar, token by token, that the
parser accepts. Tokens are the pieces of the programs of this project: of those that may come next a group is drawn (keywords, names,
symbols, blanks, ...), and one of the group. Needs llguidance, and for the second engine xgrammar.
"""

import argparse
import random
import re
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final, Protocol

from fuzz.draws import RandomDraws
from fuzz.grammar import make_program
from fuzz.layout import lay_out
from fuzz.mutations import make_mutant
from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS
from scenic.compiler.parser import parse
from scenic.constrained import grammar_text

__all__ = ["ENGINES", "Engine", "Session", "main", "programs", "sample", "sentence", "vocabulary"]

ROOT: Final = Path(__file__).parents[1]
END: Final = b"<end>"
_PIECE: Final = re.compile(r" ?\w+|\n *|[^\w\s]{1,2}|\s+")
_WEIGHTS: Final = (6, 4, 5, 1, 2, 0.3)
"""Of the groups of tokens: keywords, names and numbers, symbols, line ends, blanks, quotes and comments."""
_FURTHER: Final = 400
"""Tokens after the wanted number in which a sampled text has to come to its end."""


class Session(Protocol):
    """A text that is being written."""

    def allowed(self) -> Sequence[int]:
        """The tokens that may come next."""

    def take(self, token: int) -> None:
        """Write a token."""


class Engine(Protocol):
    """A grammar, compiled for a vocabulary."""

    def accepts(self, text: str) -> bool:
        """Return whether a text is a whole program."""

    def session(self) -> Session:
        """An empty text."""


@cache
def programs() -> tuple[str, ...]:
    """The texts of all programs of the project that the parser accepts."""
    texts = []
    for folder in ("examples", "tests/data", "benchmarks", "scenic"):
        for path in sorted((ROOT / folder).rglob("*.scenic")):
            try:
                text = path.read_text(encoding="utf-8")
            except UnicodeDecodeError:
                continue
            if not parse(text).diagnostics:
                texts.append(text)
    return tuple(texts)


@cache
def vocabulary() -> tuple[bytes, ...]:
    """The tokens, the last of which ends a text."""
    pieces = {piece.encode() for text in programs() for piece in _PIECE.findall(text)}
    words = {f"{blank}{word}".encode() for word in (*HARD_KEYWORDS, *SOFT_KEYWORDS) for blank in ("", " ")}
    return (*sorted(pieces | words | {bytes([byte]) for byte in range(256)}), END)


@cache
def _groups() -> tuple[int, ...]:
    """The group of each token, an index of `_WEIGHTS`."""
    keywords = {word.encode() for word in (*HARD_KEYWORDS, *SOFT_KEYWORDS)}

    def group(token: bytes) -> int:
        word = token.strip()
        if not word:
            return 3 if b"\n" in token else 4
        if any(each in token for each in b"'\"#\\"):
            return 5
        return 0 if word in keywords else 1 if word.isalnum() else 2

    return tuple(map(group, vocabulary()))


def sentence(seed: int) -> str:
    """A text that the fuzzer derives from the grammar of the parser, laid out as usual."""
    return lay_out(make_program(RandomDraws(seed)).pieces)


# Engines.


class _Tokens:
    """The vocabulary as llguidance wants it."""

    bos_token_id = None

    def __init__(self) -> None:
        self.tokens = vocabulary()
        self.eos_token_id = len(self.tokens) - 1
        self.special_token_ids = [self.eos_token_id]
        self._bytes = {token: number for number, token in enumerate(self.tokens)}

    def __call__(self, text: bytes | str) -> list[int]:
        data = text.encode() if isinstance(text, str) else text
        return [self._bytes[bytes([byte])] for byte in data]


class Guidance:
    """llguidance with the grammar in Lark."""

    notation = "lark"

    def __init__(self, text: str) -> None:
        import llguidance

        self._tokens = _Tokens()
        tokenizer = llguidance.LLTokenizer(llguidance.TokenizerWrapper(self._tokens), slices=[])
        self._matcher = llguidance.LLMatcher(tokenizer, llguidance.LLMatcher.grammar_from_lark(text))
        if self._matcher.is_error():
            raise ValueError(self._matcher.get_error())

    def accepts(self, text: str) -> bool:
        matcher = self._matcher.deep_copy()
        tokens = self._tokens(text)
        return matcher.try_consume_tokens(tokens) == len(tokens) and bool(matcher.is_accepting())

    def session(self) -> Session:
        return _GuidanceSession(self._matcher.deep_copy(), len(self._tokens.tokens))


class _GuidanceSession:
    def __init__(self, matcher: Any, count: int) -> None:
        self._matcher = matcher
        self._count = count

    def allowed(self) -> Sequence[int]:
        return _numbers(self._matcher.compute_bitmask(), self._count)

    def take(self, token: int) -> None:
        self._matcher.consume_token(token)


class XGrammar:
    """xgrammar with the grammar in EBNF."""

    notation = "ebnf"

    def __init__(self, text: str) -> None:
        import xgrammar

        self._library = xgrammar
        self._tokens = vocabulary()
        kind = xgrammar.VocabType.RAW
        info = xgrammar.TokenizerInfo(
            list(self._tokens), vocab_type=kind, stop_token_ids=[len(self._tokens) - 1]
        )
        compiler = xgrammar.GrammarCompiler(info, max_threads=1, cache_enabled=False)
        self._compiled = compiler.compile_grammar(text)

    def accepts(self, text: str) -> bool:
        matcher = self._library.GrammarMatcher(self._compiled)
        return bool(matcher.accept_string(text.encode()) and matcher.accept_token(len(self._tokens) - 1))

    def session(self) -> Session:
        return _XGrammarSession(self._library, self._compiled, len(self._tokens))


class _XGrammarSession:
    def __init__(self, library: Any, compiled: Any, count: int) -> None:
        self._matcher = library.GrammarMatcher(compiled)
        self._mask = library.allocate_token_bitmask(1, count)
        self._count = count

    def allowed(self) -> Sequence[int]:
        self._matcher.fill_next_token_bitmask(self._mask)
        return _numbers(self._mask.numpy().tobytes(), self._count)

    def take(self, token: int) -> None:
        self._matcher.accept_token(token)


ENGINES: Final = {"llguidance": Guidance, "xgrammar": XGrammar}


def _numbers(mask: bytes, count: int) -> list[int]:
    """The numbers of the bits that are set."""
    return [
        place * 8 + bit
        for place, byte in enumerate(mask)
        if byte
        for bit in range(8)
        if byte >> bit & 1 and place * 8 + bit < count
    ]


# Figures.


def sample(engine: Engine, seed: int, wanted: int) -> str | None:
    """A text of about ``wanted`` tokens drawn at random among those that are allowed; ``None`` if it came to no end, or is no text."""
    tokens, groups = vocabulary(), _groups()
    end = len(tokens) - 1
    draw = random.Random(seed)
    session = engine.session()
    written: list[bytes] = []
    while len(written) < wanted + _FURTHER:
        allowed = session.allowed()
        if len(written) >= wanted:
            if end in allowed:
                break
            closing = [each for each in allowed if tokens[each][:1] in (b")", b"]", b"}", b"\n", b"'", b'"')]
            allowed = closing if closing and draw.random() < 0.8 else allowed
        if written and written[-1][-1:].isalnum():
            # Otherwise most of a text would be long names.
            allowed = [each for each in allowed if not tokens[each][:1].isalnum()] or allowed
        there = sorted({groups[each] for each in allowed})
        chosen = draw.choices(there, [_WEIGHTS[group] for group in there])[0]
        token = draw.choice([each for each in allowed if groups[each] == chosen])
        if token == end:
            break
        session.take(token)
        written.append(tokens[token])
    else:
        return None
    try:
        return b"".join(written).decode()
    except UnicodeDecodeError:
        return None


def _sentences(count: int) -> Iterator[str]:
    return (text for seed in range(count) if not parse(text := sentence(seed)).diagnostics)


def _mutants(count: int) -> Iterator[str]:
    """Texts that are nearly programs, which the parser refuses."""
    short = [text for text in programs() if len(text) < 3000]

    def original(seed: int) -> str:
        return short[seed // 2 % len(short)] if seed % 2 else sentence(seed)

    for seed in range(count):
        text = make_mutant(
            RandomDraws(seed),
            original(seed),
            lambda other=seed + 1: original(other),  # type: ignore[misc]
        ).text
        has_surrogates = any("\ud800" <= character <= "\udfff" for character in text)
        if not has_surrogates and parse(text).diagnostics:
            yield text


def _accepted(text: str) -> bool:
    # What only an older Python refuses counts as a program.
    return all(each.code == "SC120" for each in parse(text).diagnostics)


def _report(name: str, arguments: argparse.Namespace) -> None:
    engine_class = ENGINES[name]
    text = grammar_text(engine_class.notation)
    start = time.process_time()
    engine: Engine = engine_class(text)
    seconds = time.process_time() - start
    count = len(vocabulary())
    lines = text.count("\n")
    _print(f"{name}: {len(text)} characters, {lines} rules, compiled in {seconds:.2f} s for {count} tokens")
    _share("programs accepted", (engine.accepts(each) for each in programs()))
    _share("sentences accepted", (engine.accepts(each) for each in _sentences(arguments.sentences)))
    _share("mutants refused", (not engine.accepts(each) for each in _mutants(arguments.mutants)))
    samples = [sample(engine, seed, 10 + seed % 90) for seed in range(arguments.samples)]
    whole = [each for each in samples if each is not None]
    _print(f"  sampled texts: {len(samples)}, of which {len(whole)} came to an end")
    _share("samples accepted by the parser", map(_accepted, whole))
    for each in [each for each in whole if not _accepted(each)][: arguments.show]:
        problem = parse(each).diagnostics[0]
        _print(f"    {problem.code} {problem.message}: {each!r}")


def _share(what: str, answers: Iterator[bool]) -> None:
    start = time.process_time()
    counts = Counter(answers)
    total = counts.total()
    spent = time.process_time() - start
    _print(f"  {what}: {counts[True]} of {total} ({counts[True] / max(1, total):.2%}), {spent:.0f} s")


def _print(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def main() -> None:
    """Print the figures of each engine."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.constrained")
    parser.add_argument("--engine", choices=tuple(ENGINES), action="append")
    parser.add_argument("--sentences", type=int, default=500)
    parser.add_argument("--mutants", type=int, default=500)
    parser.add_argument("--samples", type=int, default=300)
    parser.add_argument("--show", type=int, default=5, help="refused samples to print")
    arguments = parser.parse_args()
    for name in arguments.engine or ENGINES:
        _report(name, arguments)


if __name__ == "__main__":
    main()
