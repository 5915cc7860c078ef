"""Target of coverage-guided fuzzing: the properties of texts on bytes, and mutations of tokens among mutations of bytes.

Nothing here needs atheris; `fuzz.guided` joins the two.
"""

import random
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Final

from fuzz import corpus
from fuzz.draws import RandomDraws
from fuzz.mutations import make_mutant
from fuzz.properties import OF_TEXTS, PARSING, Case, Property
from fuzz.session import Signature, fault_of, signature_of
from fuzz.shrinking import shrunk
from scenic.compiler.generated import HARD_KEYWORDS, OPERATORS, SOFT_KEYWORDS

__all__ = ["Finding", "Mutator", "Target", "dictionary", "seeds", "text_of"]

_ROOT: Final = Path(__file__).resolve().parents[1]
_SEEDED: Final = ("examples", "tests/data", "benchmarks")
_LONGEST_SEED: Final = 1500
_SELDOM: Final = 4
"""Number of texts for each text on which the properties beyond parsing are tried."""
_SLOW: Final = 10.0
"""Seconds after which a text that long has taken too long; it should be a thousandth of that."""


def text_of(data: bytes) -> str:
    """Return the text of some bytes, as in the corpus; bytes that are not UTF-8 become question marks."""
    try:
        return data.decode("utf-8", "surrogatepass")
    except UnicodeDecodeError:
        return data.decode("utf-8", "replace")


def seeds() -> Iterator[str]:
    """The texts to begin with: the corpus, the examples and the data of the tests."""
    for entry in corpus.entries():
        yield entry.text
    for name in _SEEDED:
        for path in sorted((_ROOT / name).rglob("*.scenic")):
            text = text_of(path.read_bytes())
            if len(text) <= _LONGEST_SEED:
                yield text


def dictionary() -> str:
    """Write all keywords and operators as libFuzzer reads them."""
    words = sorted({*HARD_KEYWORDS, *SOFT_KEYWORDS, *OPERATORS})
    return "".join(f'"{word}"\n' for word in words)


class Finding(Exception):
    """A text for which a property fails that has not failed in this way before."""

    def __init__(self, signature: Signature, text: str, reason: str) -> None:
        super().__init__(f"{signature.property}: {signature.detail}")
        self.signature = signature
        self.text = text
        self.reason = reason


class Target:
    """Tries texts on ``properties``. ``report`` is called once for each kind of failure, and then the run continues."""

    def __init__(self, report: Callable[[Finding], None], properties: Sequence[Property] = OF_TEXTS) -> None:
        self._report = report
        self._properties = properties
        self._known: set[Signature] = set()
        self.tried = 0
        self.checks = 0

    def __call__(self, data: bytes) -> None:
        """Try the text that these bytes are."""
        self.tried += 1
        text = text_of(data)
        case = Case(text)
        start = time.process_time()
        for each in self._properties:
            if each not in PARSING and case.number % _SELDOM:
                continue
            self.checks += 1
            error = fault_of(each, case)
            if error is not None:
                self._found(each, text, error)
        elapsed = time.process_time() - start
        if elapsed > _SLOW:
            signature = Signature("answers_in_time", "Slow", "")
            self._tell(Finding(signature, text, f"{elapsed:.1f} s for {len(text)} characters"))

    def _found(self, broken: Property, text: str, error: BaseException) -> None:
        signature = signature_of(broken.name, error)
        if signature in self._known:
            return

        def fails(shorter: str) -> bool:
            again = fault_of(broken, Case(shorter, thorough=True))
            return again is not None and signature_of(broken.name, again) == signature

        reason = "".join(traceback.format_exception(error)[-3:])
        self._tell(Finding(signature, shrunk(text, fails), reason))

    def _tell(self, finding: Finding) -> None:
        if finding.signature not in self._known:
            self._known.add(finding.signature)
            self._report(finding)


class Mutator:
    """Changes a text: half of the time its tokens, as the mutants of `fuzz.mutations`, otherwise its bytes.

    ``of_bytes`` is libFuzzer's own mutation: it is given the bytes and the greatest length. Parts are taken from ``texts``.
    """

    def __init__(self, of_bytes: Callable[[bytes, int], bytes], texts: Sequence[str]) -> None:
        self._of_bytes = of_bytes
        self._texts = texts

    def __call__(self, data: bytes, greatest: int, seed: int) -> bytes:
        """Return changed bytes, at most ``greatest``."""
        draw = random.Random(seed)
        if draw.random() < 0.5:
            return self._of_bytes(data, greatest)
        draws = RandomDraws(seed)
        changed = make_mutant(draws, text_of(data), lambda: draw.choice(self._texts)).text
        # In the middle of a character the text would end with what is no UTF-8, which is a case like others.
        return changed.encode("utf-8", "surrogatepass")[:greatest]
