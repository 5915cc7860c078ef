"""Emits the parser: one function for each rule, all within one function that holds the state of a run.

The state is the index ``p`` of the next token, shared by all functions as a closure variable. A function returns what
the rule matched and leaves ``p`` behind it, or returns ``None`` and leaves ``p`` anywhere: whoever tries something else
then puts it back. Three parsers are emitted from one grammar. The fast one looks at the next token to choose among
alternatives. The recording one tries them all, notes how far it came and what would have gone on there, and lets
``recover`` run the loops over statements; it is used only on statements that are known to be wrong. The tracing one
tries them all, too, and its position carries the alternatives that led to it: see ``grammar.tracing``, its only user.
"""

from grammar.generator.actions import OPERATORS
from grammar.generator.model import KINDS
from grammar.generator.rules import RuleWriter


class Emitter(RuleWriter):
    """Emits one of the parsers as a module."""

    def emit(self, header: str) -> str:
        """Write the text of the module."""
        self.depth = 1
        # Upper rules first, so that tables of operators are made for whole ladders and shared by their parts.
        for rule in sorted(
            self.analysis.rules.values(),
            key=lambda each: -len(self.analysis.ladder(each.name)) if each.name in self.analysis.steps else 0,
        ):
            self.rule(rule)
        body, self.lines, self.depth = self.lines, [], 0
        self.preamble(header)
        self.lines += body
        self.depth = 1
        self.ending()
        return "\n".join(line.rstrip() for line in self.lines) + "\n"

    def preamble(self, header: str) -> None:
        translator = self.translator
        for line in header.splitlines():
            self.line(line)
        self.line("")
        for module in ("ast", "tree"):
            names = sorted(
                name for name in translator.used_classes if translator.classes[name].module == module
            )
            if module == "ast":
                names = sorted({*names, "AST", *(OPERATORS[each] for each in translator.used_operators)})
            if names:
                origin = "ast" if module == "ast" else "scenic.compiler.tree"
                self.line(f"from {origin} import ({', '.join(names)})")
        if self.tracing:
            self.line("from grammar.tracing import Position")
        self.line("")
        self.line("new = AST.__new__")
        for name in sorted(translator.used_operators):
            self.line(f"{name} = new({OPERATORS[name]})")
        for kinds, name in self.sets.items():
            words = " ".join(self.grammar.vocabulary.describe(kind) for kind in sorted(kinds))
            self.line(f"{name} = frozenset({{{', '.join(map(str, sorted(kinds)))}}})  # {words}")
        self.line("")
        self.line("")
        with self.block("def make(cls, fields, place):"):
            self.line("n = new(cls)")
            with self.block("if place is not None:"):
                self.line(
                    "fields['lineno'], fields['col_offset'], fields['end_lineno'], fields['end_col_offset'] = place"
                )
            self.line("n.__dict__ = fields")
            self.line("return n")
        self.line("")
        self.line("")
        extra = ", recover" if self.recording else ""
        self.line(f"def build(kinds, texts, lines, columns, end_lines, end_columns, actions{extra}):")
        self.depth = 1
        self.line("p = Position(0)" if self.tracing else "p = 0")
        if not self.fast:
            for line in (RECORDER if self.recording else TRACER).splitlines():
                self.line(line)
        else:
            operators = self.grammar.vocabulary.operators
            openers = sorted(operators[text] for text in "([{" if text in operators)
            closers = sorted(operators[text] for text in ")]}" if text in operators)
            for line in AHEAD.format(openers=openers, closers=closers, newline=KINDS["NEWLINE"]).splitlines():
                self.line(line)
        for name in sorted(translator.used_helpers):
            self.line(f"{name} = actions.{name}")
        for name in self.analysis.memoised:
            self.line(f"memo_{name} = {{}}")
        self.depth = 0

    def ending(self) -> None:
        for number, operators in enumerate(self.tables):
            self.line("")
            with self.block(f"table_{number} = {{"):
                for kind, entries in sorted(operators.items()):
                    loops = "".join(f"({level}, loop_{rule}), " for level, rule in entries)
                    self.line(f"{kind}: ({loops.rstrip()}),  # {self.grammar.vocabulary.describe(kind)}")
            self.line("}")
            for line in CLIMB.format(number=number).splitlines():
                self.line(line)
        starts = [self.grammar.start, *sorted(self.grammar.recover)]
        rules = ", ".join(f"{name!r}: parse_{name}" for name in starts)
        self.line("")
        self.line(f"rules = {{{rules}}}")
        self.line("")
        with self.function("run", "rule, position"):
            if self.recording:
                self.line("nonlocal far, expected, label, label_at")
                self.line("outer = far, expected, label, label_at, quiet")
                self.line("far, expected, label, label_at, quiet = -1, set(), None, -1, 0")
            self.line("p = Position(position)" if self.tracing else "p = position")
            self.line("r = rules[rule]()")
            if self.recording:
                self.line("found = far, expected")
                self.line("far, expected, label, label_at, quiet = outer")
                self.line("return r, p, *found")
            else:
                self.line("return r, p")
        if self.fast:
            self.again()
        self.line("")
        self.line("return run")

    def again(self) -> None:
        """Emit what lets the fast parser go on to another text: making its functions takes as long as many lines."""
        lists = ("kinds", "texts", "lines", "columns", "end_lines", "end_columns")
        helpers = sorted(self.translator.used_helpers)
        self.line("")
        with self.block(f"def read({', '.join(f'new_{name}' for name in lists)}, actions):"):
            self.line(f"nonlocal {', '.join([*lists, *helpers])}")
            for name in lists:
                self.line(f"{name} = new_{name}")
            for name in helpers:
                self.line(f"{name} = actions.{name}")
        self.line("")
        with self.block("def forget():"):
            self.line(f"nonlocal {', '.join([*lists, *helpers])}")
            self.line(f"{' = '.join(lists)} = ()")
            for name in helpers:
                self.line(f"{name} = None")
            self.line("found_ahead.clear()")
            for name in self.analysis.memoised:
                self.line(f"memo_{name}.clear()")
        self.line("")
        self.line("run.read = read")
        self.line("run.forget = forget")


RECORDER = """\
far = -1
expected = set()
label = None
label_at = -1
quiet = 0

def expect(kind):
    nonlocal p
    if kinds[p] == kind:
        p += 1
        return True
    if p >= far and not quiet:
        missed(kind)
    return False

def expect_name():
    nonlocal p
    if kinds[p] >= 256:
        p += 1
        return True
    if p >= far and not quiet:
        missed(256)
    return False

def expect_any(wanted):
    nonlocal p
    if kinds[p] in wanted:
        p += 1
        return True
    if p >= far and not quiet:
        for kind in wanted:
            missed(kind)
    return False

def missed(kind):
    nonlocal far, expected
    if p > far:
        far = p
        expected = set()
    expected.add(label if label_at == p else kind)
"""

TRACER = """\
def expect(kind):
    nonlocal p
    if kinds[p] == kind:
        p += 1
        return True
    return False

def expect_name():
    nonlocal p
    if kinds[p] >= 256:
        p += 1
        return True
    return False

def expect_any(wanted):
    nonlocal p
    if kinds[p] in wanted:
        p += 1
        return True
    return False
"""

AHEAD = """\
found_ahead = {{}}

def ahead(kind):
    # Is there a token of this kind, here or further on, before the bracket or the line ends?
    flags = found_ahead.get(kind)
    if flags is None:
        flags = found_ahead[kind] = {{}}
    flag = flags.get(p)
    if flag is None:
        # What holds for the other tokens up to the end of the line is found on the way.
        try:
            end = kinds.index({newline}, p)
        except ValueError:
            end = len(kinds)
        outer = []
        flag = 0
        for index in range(end - 1, p - 1, -1):
            k = kinds[index]
            if k == kind:
                flag = 1
            elif k in {closers}:
                outer.append(flag)
                flag = 0
            elif k in {openers}:
                flag = outer.pop() if outer else 0
            flags[index] = flag
        flags[p] = flag
    return flag
"""

CLIMB = """
def climb_{number}(r, s, limit):
    last = -1
    while True:
        for level, loop in table_{number}.get(kinds[p], ()):
            if last < level <= limit:
                m = p
                r = loop(r, s)
                if p != m:
                    last = level
                    break
        else:
            return r
"""
