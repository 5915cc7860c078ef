"""A new element of the language, declared once in a copy of the project, is there in every tool; implemented once, it runs."""

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]

ADDED: Mapping[str, Mapping[str, tuple[tuple[str, str], ...]]] = {
    "operator": {
        "grammar/scenic.gram": (
            (
                "    | \"front\" 'of' a=prefix {",
                """    | "gap" "between" a=expression 'to' b=prefix {
        Operation(operator="gap between", operands=[a, b]) }
""",
            ),
        ),
        "scenic/language/operators.py": (
            (
                """    Operator(
        "altitude",""",
                """    Operator(
        "gap between",
        (Operand("first", (OBJECT,)), Operand("second", (OBJECT,))),
        "scalar",
        ("gap between first to second",),
        "How much room is left between two objects.",
    ),
""",
            ),
        ),
        "scenic/runtime/elements/operators.py": (
            (
                "IMPLEMENTATIONS: Mapping",
                """def _gap_between(first: Any, second: Any) -> Any:
    return _distance_between(first.position, second.position)


""",
            ),
            (
                '        "deg": _degrees,',
                """        "gap between": _gap_between,
""",
            ),
        ),
    },
    "specifier": {
        "grammar/scenic.gram": (
            (
                '    | "behind" a=expression',
                """    | "beside" a=expression b=by_clause? {
        SpecifierPhrase(specifier="beside", property=None, operands=[a, b]) }
""",
            ),
        ),
        "scenic/language/specifiers.py": (
            (
                '    _beside("behind",',
                """    SpecifierDeclaration(
        "beside",
        (Operand("reference", (OBJECT,)), Operand("distance", (SCALAR,), "no gap")),
        (Specified("position", 1),),
        (),
        "position",
        ("beside reference", "beside reference by distance"),
        "Places the object at any side of the reference.",
        functions=(Function("Beside(pos, dist=None)"),),
    ),
""",
            ),
        ),
        "scenic/runtime/elements/specifiers.py": (
            (
                "BUILDERS: Mapping[str",
                """def beside(reference: Any, distance: Any) -> Specifier:
    return _specifier("beside", lambda _: {"position": reference.position + (distance or 1, 0, 0)})


""",
            ),
            (
                '        "behind": _directional("behind", -1),',
                """        "beside": beside,
""",
            ),
        ),
    },
    "statement": {
        "grammar/scenic.gram": (
            (
                '    | "abort" { Abort() }',
                """    | "announce" a=expression { Announce(value=a) }
""",
            ),
        ),
        "scenic/compiler/tree.py": (
            (
                "class Abort(ScenicStatement):",
                '''class Announce(ScenicStatement):
    """``announce value``."""

    value: ast.expr
    _fields = ("value",)


''',
            ),
        ),
        "scenic/language/statements.py": (
            (
                """    Statement(
        "Abort",""",
                """    Statement(
        "Announce",
        "announce",
        ("announce value",),
        frozenset({Place.TOP}),
        "Says something when the scene is made.",
    ),
""",
            ),
        ),
        "scenic/runtime/program/prelude.py": (
            (
                "    def require(self, condition",
                """    def announce(self, value: Any) -> None:
        self._program.parameters["announced"] = value

""",
            ),
        ),
    },
    "sensor": {
        "scenic/language/names.py": (
            (
                """            _sensor(
                "CallbackSensor""",
                """            _sensor("Thermometer(unit)", "Measures how warm it is.", "scenic.runtime.elements.warmth"),
""",
            ),
        ),
        "scenic/runtime/elements/warmth.py": (
            (
                "",
                """
from scenic.runtime.elements.sensors import Sensor

class Thermometer(Sensor):
    def __init__(self, unit):
        self.deliver(f"20 {unit}")
""",
            ),
        ),
    },
    "region": {
        "scenic/language/names.py": (
            (
                """    # Exceptions
""",
                """    _region("CubeRegion(center, size)", "The cube about a point.", "cubes"),
""",
            ),
        ),
        "scenic/runtime/regions/cubes.py": (
            (
                "",
                """
from scenic.runtime.regions.volumes import BoxRegion

class CubeRegion(BoxRegion):
    def __init__(self, center, size):
        super().__init__((size, size, size), center)
""",
            ),
        ),
    },
    "shape": {
        "scenic/language/names.py": (
            (
                """    # Exceptions
""",
                """    _shape("SlabShape(thickness)", "A flat square.", "scenic.runtime.elements.slabs"),
""",
            ),
        ),
        "scenic/runtime/elements/slabs.py": (
            (
                "",
                """
from scenic.runtime.shapes.shapes import PrimitiveShape
from scenic.runtime.geometry.meshes import primitives

class SlabShape(PrimitiveShape):
    kind = "slab"
    make = staticmethod(primitives.box)

    def __init__(self, thickness=1, **options):
        super().__init__(**{"dimensions": (1, 1, thickness), **options})
""",
            ),
        ),
    },
    "distribution": {
        "scenic/language/names.py": (
            (
                """    # Exceptions
""",
                """    _distribution(
        "Exponential(rate)",
        "A positive real number, the time until something happens.",
        "scenic.runtime.elements.exponential",
        types=(SCALAR,),
        result=SCALAR,
        is_complete=True,
        operation="exponential",
        noun="waiting time",
    ),
""",
            ),
        ),
        "scenic/runtime/elements/exponential.py": (
            (
                "",
                """
import numpy as np
from scenic.graph.kinds import Kind
from scenic.graph.operation import Operation, always
from scenic.runtime.values.distributions import Law, primitive

_DRAW = Operation(
    "exponential", always(Kind.SCALAR), lambda _, uniform, rate: -np.log1p(-uniform) / rate, "A waiting time."
)

@Law
def Exponential(rate):
    return primitive(_DRAW, rate)
""",
            ),
        ),
    },
    "function": {
        "scenic/language/names.py": (
            (
                """    # Exceptions
""",
                """    _function(
        "clamp(value, low, high)",
        "The nearest number between two.",
        "scenic.runtime.elements.clamping",
        lifted=True,
        is_complete=True,
    ),
""",
            ),
        ),
        "scenic/runtime/elements/clamping.py": (
            (
                "",
                """
from scenic.runtime.elements.functions import max, min

def clamp(value, low, high):
    return min(max(value, low), high)
""",
            ),
        ),
    },
    "diagnostic": {
        "scenic/language/diagnostics.py": (
            (
                '        "SC390": "ignore',
                """        "SC389": "condition that nobody doubts",
""",
            ),
        ),
        "scenic/language/explanations/SC389.md": (
            (
                "",
                """# SC389: condition that nobody doubts

A condition that is written as `True`.

## Example

```scenic
require True
```

## Message

```text
1:1: warning[SC389]: nobody doubts this
```

## Repair

Leave it out.
""",
            ),
        ),
        "scenic/compiler/checks/conditions.py": (
            (
                "RULES: Final",
                """def _undoubted(node: ast.Assert, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    if isinstance(node.test, ast.Constant) and node.test.value is True:
        yield context.warning("SC389", "nobody doubts this", node, "leave it out")


""",
            ),
            (
                "    ast.Compare: _comparison,",
                """    ast.Assert: _undoubted,
""",
            ),
        ),
    },
    "simulator": {
        "scenic/simulators/numbered_simulations.py": (
            (
                '        "dummy": "scenic',
                """        "still": "scenic.simulators.still:StillSimulator",
""",
            ),
        ),
        "scenic/simulators/still.py": (
            (
                "",
                """
from scenic.simulators.dummy import DummySimulator

class StillSimulator(DummySimulator):
    pass
""",
            ),
        ),
    },
    "output format": {
        "scenic/cli/sinks.py": (
            (
                "FILES = {",
                """@contextmanager
def _counts(path: Path, count: int) -> Iterator[Take]:
    from scenic.formats.counts import counted

    yield lambda scene: write(numbered(path, scene.k, count), counted(scene))


""",
            ),
            ('    ".glb": _glb_files,\n', '    ".count": _counts,\n'),
        ),
        "scenic/formats/counts.py": (
            (
                "",
                """
def counted(scene):
    return f"{len(scene.objects)} objects\\n".encode()
""",
            ),
        ),
    },
    "feature of the language server": {
        "scenic/lsp/handlers/structure.py": (
            (
                "HANDLERS: Final",
                """def _suggestions(session: Session, params: types.InlineCompletionParams) -> list[types.InlineCompletionItem]:
    from scenic.ide.suggestions import suggestions

    return [types.InlineCompletionItem(each) for each in suggestions(session.document(params.text_document.uri).snapshot)]


""",
            ),
            (
                "    types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: _symbols",
                """    types.TEXT_DOCUMENT_INLINE_COMPLETION: _suggestions,
""",
            ),
        ),
        "scenic/lsp/handlers/__init__.py": (
            (
                "        types.TEXT_DOCUMENT_DOCUMENT_SYMBOL,",
                "        types.TEXT_DOCUMENT_INLINE_COMPLETION,\n",
            ),
        ),
        "scenic/ide/suggestions.py": (
            (
                "",
                """
def suggestions(snapshot):
    return ["ego = new Object"] if not snapshot.text.strip() else []
""",
            ),
        ),
    },
}
"""By kind of element, by file: what is written, and the line before which; of a new file nothing stands before."""

SCRIPT = r"""
import ast, json, subprocess, sys
from pathlib import Path
from hypothesis import HealthCheck, given, settings
from scenic.compiler.check import check_text
from scenic.compiler.parser import parse
from scenic.ide.continuations import continuations
from scenic.ide.formatting import format_text
from scenic.ide.hover import hover
from scenic.ide.pygments_lexer import ScenicLexer
from scenic.ide.snapshot import Snapshot
from editors.generate import texts

from fuzz.derivations import AlternativeId
from fuzz.grammar import Limits, programs
from grammar.generator import read_grammar

TEXT = "x = gap between a to b\nego = new Object beside x by 3\nannounce x\n"

def nodes(text):
    parsed = parse(text)
    assert not parsed.diagnostics, parsed.diagnostics
    return [type(node).__name__ + ":" + str(getattr(node, "operator", getattr(node, "specifier", "")))
            for node in ast.walk(parsed.tree)]

def offered(text):
    return [item.form for item in continuations(text, 1, len(text)).items]

def shown(line, column):
    found = hover(Snapshot(TEXT, "x"), line, column)
    return "" if found is None else found.markdown

grammar = read_grammar(Path("grammar/scenic.gram"))
words = {}
for rule, word in (("prefix_operation", "gap"), ("specifier", "beside"), ("soft_statement", "announce")):
    alternatives = grammar.rules[rule].alternatives
    [number] = [n for n, each in enumerate(alternatives, 1) if getattr(each.items[0].item, "text", "") == word]
    found = set()
    @settings(max_examples=20, deadline=None, database=None, derandomize=True, suppress_health_check=list(HealthCheck))
    @given(programs(rule, limits=Limits(depth=2, expansions=8), aims=[AlternativeId(rule, number)]))
    def collect(program):
        found.update(piece.text for piece in program.pieces)
    collect()
    words[rule] = sorted(found & {"gap", "beside", "announce"})

import importlib
import scenic
from scenic.analysis.fact_diagnostics import _NOUNS
from scenic.ide.completion import completions
from scenic.project.index import Project
from scenic.runtime.shapes.shapes import primitive_of
from scenic.runtime.scenes.dumping import literal
from scenic.runtime.values.source_text import spelled

from lsprotocol import types
from scenic.lsp.server import Server
from scenic.simulators.numbered_simulations import choose_simulator

scenario = scenic.scenarioFromString(
    "from scenic import Thermometer\n"
    "x = Exponential(2)\nassert isinstance(x, Exponential)\nroom = CubeRegion((0, 0, 9), 4)\nrequire clamp(x, 0, 1) < 0.9\n"
    "ego = new Object in room, with tag clamp(x, 0, 0.1), with drawn x\nother = new Object beside ego by 3\n"
    "param gap = gap between ego to other\n"
    "announce x\nslab = new Object at (9, 9, 9), with shape SlabShape(0.3), with sensors {'warmth': Thermometer('C')}\n"
)
[scene] = scenario.sample(1, seed=1)
ego, other, slab = scene.objects

def messages(text):
    return [" ".join(filter(None, (item.code, item.message, item.help))) for item in check_text(text, filename="x")]

def imported(module, name):
    return getattr(importlib.import_module(module), name).__name__

Path("counted.scenic").write_text("ego = new Object\n")
subprocess.run([sys.executable, "-m", "scenic", "sample", "counted.scenic", "-o", "scene.count"], check=True)
server = Server()
features = server.protocol.fm.features
features["initialize"](types.InitializeParams(types.ClientCapabilities()))

typed = Path("typed.scenic").resolve()
typed.write_text("x = ")
NAMED = ("a = CubeRegion((0, 0, 0), 1)\nb = Exponential(2)\nc = clamp(1, 2, 3)\nd = SlabShape(1)\n"
         "from scenic import Thermometer\ne = Thermometer('K')\n")
project = Project(["."])
files = texts()
print(json.dumps({
    "spelled": spelled(scenario.objects[0].drawn.node),
    "scene": [max(abs(part - 9 * (axis == 2)) for axis, part in enumerate(ego.position)), ego.drawn, ego.tag,
              list(other.position - ego.position)],
    "announced": scene.params["announced"],
    "slab": [slab.height, slab.sensors["warmth"].getObservation(), literal(slab.shape),
             primitive_of("slab").__name__],
    "written": format_text(TEXT),
    "noun": _NOUNS["exponential"],
    "gap": scene.params["gap"],
    "doubted": messages("assert True\n"),
    "simulator": type(choose_simulator("still", scenario)).__name__,
    "counted": Path("scene.count").read_text(),
    "features": sorted(features),
    "wrong": messages("x = Exponential()\ny = clamp(1, 2)\nnew Object at Exponential(1)\nnew Object in CubeRegion\nnew SlabShape\nThermometer(3)"),
    "imported": [imported("scenic.core.regions", "CubeRegion"), imported("scenic.core.distributions", "Exponential"),
                 imported("scenic.syntax.veneer", "Beside"), imported("scenic.syntax.veneer", "clamp"),
                 imported("scenic.core.shapes", "SlabShape"), imported("scenic.core.sensors", "Thermometer")],
    "named": [hover(Snapshot(NAMED, str(typed)), line, 5, lambda: project).markdown for line in (1, 2, 3, 4, 6)],
    "completed": [item.label for item in completions(project, Snapshot("x = ", str(typed)), 1, 4).items],
    "nodes": nodes(TEXT),
    "codes": sorted({item.code for item in check_text(TEXT, filename="x")}),
    "fuzzed": words,
    "offered": [offered("x = "), offered("new Object "), offered(""), offered("new Object beside x ")],
    "hover": [shown(1, 5), shown(2, 18), shown(3, 2)],
    "colours": [[str(kind), text] for kind, text in ScenicLexer().get_tokens(TEXT)],
    "textmate": json.loads(files["editors/vscode/syntaxes/scenic.tmLanguage.json"]),
    "vim": files["editors/neovim/syntax/scenic.vim"],
    "docs": files["docs/reference/syntax.md"],
    "diagrams": {name: text for name, text in files.items() if name.endswith(("announce.svg", "specifiers.svg"))},
}))
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Any:
    root = tmp_path_factory.mktemp("project")
    for name in ("scenic", "grammar", "fuzz", "editors"):
        # Compiled modules are copied, too: those of unchanged files need not be compiled again.
        ignored = shutil.ignore_patterns("corpus", "node_modules", ".*.tmp")
        shutil.copytree(ROOT / name, root / name, ignore=ignored)
    for path, changes in (item for files in ADDED.values() for item in files.items()):
        text = (root / path).read_text(encoding="utf-8") if changes[0][0] else ""
        for before, added in changes:
            assert not before or text.count(before) == 1, before
            text = text.replace(before, added + before) if before else added
        (root / path).write_text(text, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        cwd=root,
        env={**os.environ, "PYTHONPATH": str(root)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout)


def test_the_parser_has_them(found: Any) -> None:
    assert {"Operation:gap between", "SpecifierPhrase:beside", "Announce:"} <= set(found["nodes"])


def test_checks_know_them(found: Any) -> None:
    assert not {"SC900", "SC999"} & set(found["codes"])
    assert any(message.startswith("SC389 nobody doubts this") for message in found["doubted"])


def test_the_fuzzer_makes_them(found: Any) -> None:
    for rule, word in (("prefix_operation", "gap"), ("specifier", "beside"), ("soft_statement", "announce")):
        assert word in found["fuzzed"][rule]


def test_completion_offers_them(found: Any) -> None:
    operators, specifiers, statements, rest = found["offered"]
    assert "gap between first to second" in operators
    assert {"beside reference", "beside reference by distance"} <= set(specifiers)
    assert "announce value" in statements
    assert "by" in rest


def test_hovering_explains_them(found: Any) -> None:
    operator, specifier, statement = found["hover"]
    assert "room is left" in operator
    assert "any side of the reference" in specifier
    assert "when the scene is made" in statement


def test_highlighters_know_them(found: Any) -> None:
    colours = {text: kind for kind, text in found["colours"]}
    assert colours["gap between"] == colours["beside"] == "Token.Operator.Word"
    assert colours["announce"] == "Token.Keyword"
    patterns = " ".join(each.get("match", "") for each in found["textmate"]["patterns"])
    for word in ("gap[ \\t]+between", "beside", "announce"):
        assert word in patterns
    for word in (r"gap\s\+between", "beside", "announce"):
        assert word in found["vim"]


def test_the_documentation_has_them(found: Any) -> None:
    for text in ("`gap` `between` *first* `to` *second*", "`beside` *reference*", "- `announce value`"):
        assert text in found["docs"]
    assert ">announce<" in found["diagrams"]["docs/reference/syntax/announce.svg"]
    assert ">beside<" in found["diagrams"]["docs/reference/syntax/specifiers.svg"]


def test_programs_find_what_is_implemented(found: Any) -> None:
    distance, drawn, tag, way = found["scene"]
    assert distance <= 2
    assert 0 < drawn < 0.9
    assert tag == min(drawn, 0.1)
    assert way == [3, 0, 0]
    assert found["announced"] == drawn
    assert found["gap"] == 3
    assert found["slab"] == [0.3, "20 C", "SlabShape(dimensions=(1.0, 1.0, 0.3))", "SlabShape"]


def test_outputs_simulators_and_the_server_have_theirs(found: Any) -> None:
    assert found["counted"] == "1 objects\n"
    assert found["simulator"] == "StillSimulator"
    assert "textDocument/inlineCompletion" in found["features"]


def test_the_table_of_the_architecture_counts_the_files_of_each() -> None:
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([a-z -]+?) \| [^|]+ \| (\d+) \|$", text, re.MULTILINE)
    counts = {kind: int(count) for kind, count in rows}
    assert counts == {kind: len(files) for kind, files in ADDED.items()}
    assert max(counts.values()) <= 5
    assert sum(counts.values()) <= 30


def test_statements_are_written_as_the_grammar_has_them(found: Any) -> None:
    assert "announce x" in found["written"].splitlines()


def test_python_finds_it_under_the_established_names(found: Any) -> None:
    assert found["imported"] == [
        "CubeRegion",
        "Exponential",
        "Beside",
        "clamp",
        "SlabShape",
        "Thermometer",
    ]


def test_names_are_explained_and_offered(found: Any) -> None:
    region, distribution, function, shape, sensor = found["named"]
    assert "The cube about a point" in region
    assert "time until something happens" in distribution
    assert "nearest number between two" in function
    assert "flat square" in shape
    assert "how warm" in sensor
    assert {"CubeRegion", "Exponential", "SlabShape", "clamp"} <= set(found["completed"])


def test_messages_know_its_parameters_its_type_and_its_noun(found: Any) -> None:
    arity, other_arity, kind = (message for message in found["wrong"][:3])
    assert any("`SlabShape` is a shape of the language" in message for message in found["wrong"])
    assert any("import it: `from scenic import Thermometer`" in message for message in found["wrong"])
    assert arity.startswith("SC211")
    assert "`Exponential`" in arity
    assert other_arity.startswith("SC211")
    assert "`clamp`" in other_arity
    assert kind.startswith("SC404 `at`: expected a vector, not a number")
    assert found["noun"] == "waiting time"
    assert found["spelled"] == "Exponential(2)"
