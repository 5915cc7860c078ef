"""``python -m fuzz.guided``: coverage-guided fuzzing of the lexer, the parser and the static check, with atheris.

The compiler is instrumented; texts that reach code not reached before are kept and changed further. They begin with the
corpus, the examples and the data of the tests. What must hold of every text (`fuzz.properties.OF_TEXTS`) is tried on each;
what fails is shrunk, shown and saved in ``fuzz/corpus``, and the run goes on.
"""

import argparse
import importlib.util
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

__all__ = ["Progress", "main", "not_compiler"]

_MISSING: Final = (
    "coverage-guided fuzzing needs atheris, which is not installed: `pip install -e '.[fuzz]'` in the checkout installs it "
    "(there are packages for Linux and CPython 3.11 to 3.13)"
)
_MINUTES: Final = 5.0
_LONGEST: Final = 1500
"""The greatest length of a text, in bytes."""
_TIMEOUT: Final = 60
"""Seconds after which libFuzzer ends a run that does not come back."""
_STATUS: Final = re.compile(r"#(\d+)\s+(\w+)\s+cov: (\d+) ft: (\d+) corp: (\d+)/(\S+)")


class Progress:
    """The progress of a run, from libFuzzer's output: the numbers of texts, of reached places in the code, and
    of kept texts.
    """

    def __init__(self) -> None:
        self.texts = 0
        self.first: int | None = None
        self.reached = 0
        self.kept = 0

    def note(self, line: str) -> bool:
        """Read a line of output; return whether it reports progress."""
        found = _STATUS.match(line)
        if found is None:
            return False
        self.texts, self.reached, self.kept = int(found[1]), int(found[3]), int(found[5])
        # Before `INITED` the texts to begin with are read.
        if self.first is None and found[2] == "INITED":
            self.first = self.reached
        return True

    def __str__(self) -> str:
        first = self.reached if self.first is None else self.first
        return f"{self.texts} texts; {first} places reached at the beginning, {self.reached} at the end; {self.kept} texts kept"


def main(arguments: list[str] | None = None) -> int:
    """Fuzz for a while; return 1 if something was found, 2 if atheris is missing."""
    options = _options().parse_args(arguments)
    if importlib.util.find_spec("atheris") is None:
        print(_MISSING, file=sys.stderr)
        return 2
    if options.inside is not None:
        _fuzz(options.inside, options)
        return 0
    with tempfile.TemporaryDirectory(prefix="scenic-guided-") as temporary:
        folder = Path(options.folder or temporary)
        return _watch(folder, options)


def _options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m fuzz.guided", description=__doc__)
    parser.add_argument(
        "--minutes", type=float, default=_MINUTES, help=f"how long to run (default: {_MINUTES:g})"
    )
    parser.add_argument("--seed", type=int, default=1, help="libFuzzer's seed (default: 1)")
    parser.add_argument(
        "--folder", help="keep what was found worth keeping here, and begin with it the next time"
    )
    parser.add_argument("--no-save", action="store_true", help="do not write failures to fuzz/corpus")
    parser.add_argument("--inside", type=Path, help=argparse.SUPPRESS)
    return parser


def _watch(folder: Path, options: argparse.Namespace) -> int:
    """Run the fuzzing process, and report on it: libFuzzer ends its process itself."""
    command = [
        sys.executable,
        "-m",
        "fuzz.guided",
        "--inside",
        str(folder),
        "--minutes",
        str(options.minutes),
    ]
    command += ["--seed", str(options.seed), *(["--no-save"] if options.no_save else [])]
    progress = Progress()
    failures = 0
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="backslashreplace"
    ) as process:
        assert process.stdout is not None
        try:
            for line in process.stdout:
                failures += line.startswith("FAILED")
                if not progress.note(line) or "NEW" not in line:
                    print(line, end="", flush=True)
        except KeyboardInterrupt:
            process.terminate()
    for path in _left_over(folder):
        failures += 1
        print(f"FAILED: the process ended with a text: {path.name}: {path.read_bytes()!r}")
    print(f"{progress}; {failures} failures; seed {options.seed}")
    if process.returncode and not failures:
        print(f"the process ended with exit code {process.returncode}")
        return 1
    return 1 if failures else 0


def _left_over(folder: Path) -> Iterator[Path]:
    """Yield the files that libFuzzer leaves when a text takes too long, or the interpreter crashes."""
    for kind in ("crash", "timeout", "oom"):
        yield from sorted(folder.glob(f"{kind}-*"))


def not_compiler() -> Iterator[str]:
    """Yield the modules of the package that are not to be instrumented; atheris chooses packages by their first name only."""
    package = Path(__file__).resolve().parents[1] / "scenic"
    for path in package.rglob("*.py"):
        name = ".".join(path.relative_to(package.parent).with_suffix("").parts).removesuffix(".__init__")
        if not f"{name}.".startswith("scenic.compiler."):
            yield name


def _fuzz(folder: Path, options: argparse.Namespace) -> None:
    """Run the fuzzing process.

    The imports are here, since only modules imported after the hook are instrumented.
    """
    atheris: Any = importlib.import_module("atheris")
    with atheris.instrument_imports(include=["scenic"], exclude=list(not_compiler())):
        target: Any = importlib.import_module("fuzz.target")
    corpus: Any = importlib.import_module("fuzz.corpus")

    def report(finding: Any) -> None:
        print(f"\nFAILED {finding}\n    = {finding.text!r}\n{finding.reason}")
        if not options.no_save:
            path = corpus.save(finding.text, finding.signature.property, of_grammar=False)
            print(f"    saved as {path.name}")
        sys.stdout.flush()

    corpus_folder, begin = folder / "kept", folder / "begin"
    corpus_folder.mkdir(parents=True, exist_ok=True)
    begin.mkdir(exist_ok=True)
    texts = list(target.seeds())
    for number, text in enumerate(texts):
        (begin / f"{number:04}").write_bytes(text.encode("utf-8", "surrogatepass"))
    words = folder / "words"
    words.write_text(target.dictionary(), encoding="utf-8")
    atheris.Setup(
        [
            sys.argv[0],
            f"-max_total_time={round(options.minutes * 60)}",
            f"-max_len={_LONGEST}",
            f"-timeout={_TIMEOUT}",
            f"-seed={options.seed}",
            f"-dict={words}",
            f"-artifact_prefix={folder}/",
            "-rss_limit_mb=4096",
            str(corpus_folder),
            str(begin),
        ],
        target.Target(report),
        # Looked up each time, since there is another function of this name once fuzzing has begun.
        custom_mutator=target.Mutator(lambda data, greatest: atheris.Mutate(data, greatest), texts),
    )
    atheris.Fuzz()


if __name__ == "__main__":
    sys.exit(main())
