"""Members of a program's classes of objects: in a scene, a condition or a simulation they see what that sample holds."""

import pickle
from itertools import pairwise

import pytest

from scenic.runtime.elements.operators import OPERATORS
from scenic.runtime.program.prelude import Prelude
from scenic.runtime.values.ownership import EGOLESS, EGOLESS_OPERATORS
from scenic.simulators.dummy import DummySimulation, DummySimulator
from tests.runtime.programs import params, scenario, scene

CLASSES = """
import functools
r = Range(1, 2)
o = new Object at (30, 30), with size r
def helper(): return r
def of_type(x): return type(x).fixed()
class B:
    table = {'r': [r], 'o': o}
    drawn = r
    def plain(self): return r
    def helped(self): return helper()
    def size(self): return r
    def default(self, x=r): return x
    def keyword(self, *, x=r): return x
    def explicit(self): return B.fixed()
    def by_type(self): return type(self).fixed()
    def by_helper(self): return of_type(self)
    def made(self):
        yield r
    @property
    def side(self): return self._side if '_side' in self.__dict__ else r
    @side.setter
    def side(self, value): self._side = value + r
    @side.deleter
    def side(self): self._side = -r
    @property
    def through(self): return type(self).of_class()
    @staticmethod
    def fixed(): return r
    @classmethod
    def of_class(cls): return cls.fixed()
    @classmethod
    def kept(cls): return cls.drawn
    @functools.cached_property
    def lasting(self): return r
    @functools.cache
    def cached(self): return r
    def counted(self): return len(self)
    def __len__(self): return int(r * 1000)
    def __call__(self, times): return times * r
    def __getitem__(self, name): return (name, r)
    def __iter__(self): return iter([r])
    def __contains__(self, x): return x == r
class M:
    def size(self): return -r
class D(B):
    def size(self): return super().size() + 0
    def unbound(self): return B.plain(self)
    @property
    def side(self): return super().side
    @classmethod
    def of_class(cls): return super().of_class()
    @staticmethod
    def nested(): return (lambda: D.fixed())()
class E(D, M):
    pass
"""

EXPRESSIONS = [
    "p.plain()",
    "p.helped()",
    "p.size()",
    "p.default()",
    "p.keyword()",
    "p.explicit()",
    "p.by_type()",
    "p.by_helper()",
    "[*p.made()][0]",
    "p.side",
    "p.through",
    "p.fixed()",
    "p.of_class()",
    "p.kept()",
    "p.lasting",
    "p.cached()",
    "p(1)",
    "p['x'][1]",
    "list(p)[0]",
    "p.table['r'][0]",
    "p.table['o'].size",
    "p.drawn",
    "p.unbound()",
    "p.nested()",
]

IN_CONDITIONS = ["D.fixed()", "D.of_class()", "E.kept()", "D.drawn", "D.table['r'][0]", "B.plain(p)"]


@pytest.mark.parametrize("cls", ["D", "E"])
def test_members_in_scenes_and_conditions_read_the_values_of_their_sample(cls: str) -> None:
    holds = [f"abs(({text}) - q.fixed()) < 1e-9 and ({text}) > 1.1" for text in EXPRESSIONS + IN_CONDITIONS]
    text = "".join(f"require {hold}\n" for hold in [*holds, "len(p) > 1100", "p.fixed() in p"])
    found = scenario(
        f"{CLASSES}ego = new Object\nq = new B at (9, 9)\np = new {cls} at (20, 20)\nparam r = r\n{text}"
    ).sample(5, seed=1)
    assert len({item.params["r"] for item in found}) == 5
    for item in found:
        p, r = item.objects[-1], item.params["r"]
        assert type(r) is float
        values = [eval(text, {"p": p}) for text in EXPRESSIONS]
        assert values == [r] * len(EXPRESSIONS)
        assert (len(p), p.counted(), r in p, 1.5 in p) == (int(r * 1000), int(r * 1000), True, False)
        p._side = 5
        assert p.side == 5
        assert item.objects[1] is p.table["o"]


def test_properties_of_scenes_are_set_and_deleted_with_the_values_of_their_sample() -> None:
    item = scene(f"{CLASSES}p = new B\nparam r = r", seed=3)
    p, r = item.objects[-1], item.params["r"]
    p.side = 10
    assert p.side == 10 + r
    del p.side
    assert p.side == -r


@pytest.mark.parametrize("part", ["getter", "setter", "deleter"])
@pytest.mark.parametrize(("header", "made"), [("class A:", "new A at (9, 9)"), ("class A(abc.ABC):", "A()")])
def test_each_part_of_a_property_finds_the_names_that_it_alone_reads(
    header: str, made: str, part: str
) -> None:
    text = f"""
import abc
r = Range(1, 2)
{header}
    @property
    def p(self): return {"r" if part == "getter" else 0}
    @p.setter
    def p(self, value): self.seen = {"r" if part == "setter" else 0}
    @p.deleter
    def p(self): self.gone = {"r" if part == "deleter" else 0}
a = {made}
ego = new Object with held a
def look():
    a.p = 3
    first = a.seen
    del a.p
    return first + a.gone + a.p
require look() > 1.2
require look() == r
param r = r
"""
    for item in scenario(text).sample(4, seed=3):
        a, r = item.egoObject.held, item.params["r"]
        a.p = 3
        del a.p
        assert a.p + a.seen + a.gone == r > 1.2


def test_slots_of_all_bases_hold_the_values_of_the_sample() -> None:
    text = """
import abc
class First(abc.ABC):
    __slots__ = ("a",)
    def held(self): return self.a
class Second(First):
    __slots__ = ("b",)
class Third(Second):
    __slots__ = ("c", "empty")
r = Range(0, 1)
k = Third()
k.a, k.b, k.c = r, (r,), [r]
def small(): return k.held() == k.a == k.b[0] == k.c[0] == r and r < 0.5
require small()
ego = new Object with held k
param r = r
"""
    for item in scenario(text).sample(3, seed=1):
        k, r = item.egoObject.held, item.params["r"]
        assert (k.a, k.b, k.c, k.held()) == (r, (r,), [r], r)
        assert not hasattr(k, "empty")


HOLDERS = """
from collections import Counter, OrderedDict, defaultdict, deque, namedtuple
g, h = Range(1, 2), Range(3, 4)
class Row(list):
    def read(self): return (list(self), self.mark, g)
    def append(self, item): super().append([item])
    def clear(self): raise ValueError("fixed")
class Queue(deque):
    def read(self): return (list(self), self.mark, g)
class Table(dict):
    def read(self): return (sorted(self.items()), self.mark, g)
    def update(self, *items): raise ValueError("fixed")
class Ordered(OrderedDict):
    def read(self): return (list(self.items()), self.mark, g)
class Filled(defaultdict):
    def read(self): return (list(self.items()), self.default_factory, self.mark, g)
class Tally(Counter):
    def read(self): return (list(self.items()), self.mark, g)
class Bag(set):
    def read(self): return (sorted(self), self.mark, g)
class Pair(namedtuple("Pair", "a b")):
    def read(self): return (self.a, self.b, g)
class Trio(tuple):
    def read(self): return (list(self), g)
class Plain(list):
    def total(self): return sum(self)
held = [Row([h, 5]), Queue([h, 5], maxlen=2), Table(a=h, b=5), Ordered(b=h, a=5), Filled(list, a=h), Tally(a=h), Bag([h, 5]), Pair(h, [h]), Trio((h, 5))]
for each in held[:7]:
    each.mark = [h]
still, loop = Pair(3, 4), Row([h, 7])
loop[1] = loop
loop.mark = loop
def read(): return [each.read() for each in [*held, still]]
def whole(): return read() + [type(each) for each in held] + [loop[1] is loop and loop.mark is loop and len(loop)]
"""


def test_containers_of_classes_of_the_program_are_sampled_as_they_are() -> None:
    """With their class, their attributes and what they hold: in scenes, in conditions and in simulations."""
    text = (
        f"{HOLDERS}def right(g, h, found):\n    return found == [([h, 5], [h], g), ([h, 5], [h], g), ([('a', h), ('b', 5)], [h], g),\n"
        "        ([('b', h), ('a', 5)], [h], g), ([('a', h)], list, [h], g), ([('a', h)], [h], g), ([h, 5], [h], g), (h, [h], g), ([h, 5], g), (3, 4, g),\n"
        "        Row, Queue, Table, Ordered, Filled, Tally, Bag, Pair, Trio, 2]\n"
        "require right(g, h, whole())\nego = new Object with held held, with plain Plain([1, 2])\n"
        "param g = g, h = h\nrecord initial right(g, h, whole()) as found\n"
    )
    for item in scenario(text).sample(2, seed=1):
        g, h = item.params["g"], item.params["h"]
        found = [each.read() for each in item.egoObject.held]
        assert found[0] == ([h, 5], [h], g)
        assert found[7:] == [(h, [h], g), ([h, 5], g)]
        assert item.egoObject.held[1].maxlen == 2
        assert item.egoObject.plain.total() == 3
        done = DummySimulator().simulate(item, maxSteps=1)
        assert done is not None
        assert done.records["found"] is True


@pytest.mark.parametrize(
    ("define", "read"),
    [
        ("from collections import defaultdict\nd = defaultdict(lambda: r)", "d['new']"),
        (
            "from collections import defaultdict\nclass D(defaultdict):\n    def told(self): return self['new'] + 0 * r\nd = D(lambda: r)",
            "d.told()",
        ),
        ("from collections import defaultdict\nclass D(defaultdict): pass\nd = D(lambda: r)", "d['new']"),
        ("class D(dict): pass\nd = D(a=r)", "d['a']"),
        ("class D(dict): pass\nd = D(a=1)\nd.mark = r", "d.mark"),
        ("class D(set): pass\nd = D([r])", "min(d)"),
        ("class D(frozenset): pass\nd = D([r])", "min(d)"),
        ("class D(frozenset):\n    def told(self): return min(self) + 0 * r\nd = D([r])", "d.told()"),
        (
            "from collections import deque\nclass D(deque): pass\nd = D([5, r], 1)",
            "d[0] if len(d) == 1 else 9",
        ),
        ("from collections import OrderedDict\nclass D(OrderedDict): pass\nd = D(a=r)", "d['a']"),
        ("from functools import partial\nd = partial(max, r, 0)", "d(-1)"),
        ("from functools import partial\nd = partial(dict, a=r)", "d()['a']"),
        ("from functools import partial\nd = partial(max, 0)\nd.mark = [r]", "d.mark[0]"),
        (
            "from functools import partial\nclass D(partial):\n    def told(self): return self(0) + 0 * r\nd = D(max, r)",
            "d.told()",
        ),
        (
            (
                "class A(object):\n    def told(self): return r\nclass D(A):\n    __slots__ = ('held', 'none')\n"
                "    def told(self): return self.held[0] + super().told() - r\nd = D()\nd.held, d.mark = [r], r"
            ),
            "d.told() if d.mark == d.held[0] and not hasattr(d, 'none') else 9",
        ),
        ("class D(tuple): pass\nd = D([1])\nd.mark = [r]", "d.mark[0]"),
        ("class D(tuple): pass\nd = D([r])\nd.mark = 0", "d[d.mark]"),
        (
            "class D(frozenset):\n    def told(self): return min(self) + 0 * r\nd = D([r])\nd.mark = r",
            "d.mark",
        ),
        ("class D(list): pass\nd = D([r])\nd.mark = [r]", "max(*d, *d.mark)"),
    ],
)
def test_what_derives_from_classes_of_python_is_sampled_with_all_that_it_holds(
    define: str, read: str
) -> None:
    """In conditions as in what scenes hand out, whether or not its class has methods of the program."""
    text = (
        f"r = Range(0, 1)\n{define}\nego = new Object\n"
        f"def check():\n    if not 0.3 < ({read}) < 0.6: return False\n    return True\n"
        "require check()\nparam r = r, d = d, check = check\n"
    )
    for item in scenario(text).sample(3, seed=1):
        assert 0.3 < item.params["r"] < 0.6
        assert item.params["check"]()
        assert eval(read, {"d": item.params["d"]}) == item.params["r"]


def test_a_mapping_that_refers_to_itself_by_what_fills_it_is_sampled_once() -> None:
    text = (
        "from collections import defaultdict\nr = Range(0, 1)\nd = defaultdict()\nd.default_factory = lambda: (d, r)\n"
        "ego = new Object\nparam d = d, r = r"
    )
    found = params(text)
    assert found["d"]["new"] == (found["d"], found["r"])
    assert found["d"]["new"][0] is found["d"]


def test_a_member_that_reads_nothing_random_is_that_of_the_program() -> None:
    program = scenario(
        "class A:\n    def f(self): return 1\n    k = (1, 2)\nego = new A at (Range(0, 1), 0, 0)"
    )
    first, second = (item.objects[0] for item in program.sample(2))
    assert first.f.__func__ is second.f.__func__
    assert first.k is second.k
    assert type(first) is type(second)


def test_methods_that_read_nothing_random_themselves_keep_their_defaults_and_find_the_sample() -> None:
    """What they call by the type of an object asks for the sample of its caller."""
    text = (
        "total = Range(3, 4)\nclass Car:\n    @classmethod\n    def limit(cls): return total\n"
        "    def ask(self, n=2, *, k=3):\n        'Asks.'\n        return type(self).limit() * n + k\n"
        "    ask.unit = 'm'\n"
        "    def told(self): return self.ask.unit, self.ask.__doc__, self.ask.__name__, self.ask.__qualname__\n"
        "ego = new Car\nparam a = ego.ask(), b = ego.ask(5, k=1), told = ego.told(), total = total\n"
        "require ego.ask() > 3 + 2 * 3.5\n"
    )
    for found in scenario(text).sample(10, seed=1):
        total, ego = found.params["total"], found.objects[0]
        assert total > 3.5
        assert found.params["a"] == ego.ask() == 2 * total + 3
        assert found.params["b"] == ego.ask(5, k=1) == 5 * total + 1
        assert found.params["told"] == ("m", "Asks.", "ask", "Car.ask")


@pytest.mark.parametrize(
    ("body", "reads_ego"),
    [
        ("str(x) + str(int(x))", False),
        ("max(*[x, 2])", False),
        ("x deg", False),
        ("x @ 2", False),
        ("F at (x, 2)", False),
        ("(x, 0) offset by (1, 2)", False),
        ("1 relative to x", False),
        ("(x, 0) offset along 30 deg by (1, 2)", False),
        ("(follow F from (x, 1) for 2).position", False),
        ("RectangularRegion((0, 0), 0, 4, 4) intersects CircularRegion((x, 0), 2)", False),
        ("str(ego.position.x)", True),
        ("distance to (x, 2)", True),
        ("angle from (x, 2)", True),
        ("relative heading of x", True),
        ("distance past (x, 2)", True),
        ("(follow F from ego for x).position", True),
        ("(lambda: (distance to (x, 2)) deg)()", True),
    ],
)
def test_methods_are_those_of_a_sample_only_where_they_may_read_the_ego(body: str, reads_ego: bool) -> None:
    text = (
        f"F = VectorField('F', lambda place: 0)\nclass A:\n    def f(self, x=3): return {body}\n"
        f"ego = new A at (Range(0, 1), Range(0, 1), 0), facing Range(0, 1)\nx = 3\nparam p = {body}"
    )
    first, second = scenario(text).sample(2)
    methods = [item.objects[0].f for item in (first, second)]
    assert [method() for method in methods] == [first.params["p"], second.params["p"]]
    assert (methods[0].__func__ is methods[1].__func__) == (not reads_ego)
    assert (methods[0]() == methods[1]()) == (not reads_ego)


def test_what_is_called_of_the_prelude_without_an_ego_has_none() -> None:
    """By the code of the prelude itself, which keeps ego and workspace in its module."""
    for name in EGOLESS:
        names = set(getattr(Prelude, name).__code__.co_names)
        assert not {"_module", "_ego", "ego", "workspace"} & names
        # An assignment asks the context whether it is sampling, and for the mode.
        assert "_context" not in names or name == "assigned"
    assert set(OPERATORS) >= EGOLESS_OPERATORS
    assert not {"can see", "initial scenario", "distance", "visible"} & EGOLESS_OPERATORS


def test_what_a_class_holds_can_be_bound_anew() -> None:
    text = (
        "class A:\n    k = Range(0, 1)\n    items = []\nA.items.append(Range(3, 4))\nA.k = 7\nego = new A\n"
    )
    made = scene(f"{text}param x = ego.k, items = A.items")
    assert made.params["x"] == made.objects[0].k == 7
    assert 3 < made.params["items"][0] < 4
    assert made.objects[0].items == made.params["items"]


def test_functions_that_lead_to_definite_instances_find_those_of_their_sample() -> None:
    text = """
ego = new Object
p = new Object at (9, 9)
def is_ego(x): return x is ego
def is_p(x): return x is p
class A:
    def leader(self): return ego
    @staticmethod
    def other(): return p
a = new A at (20, 20)
u = Uniform(ego, p)
param u = u
require is_ego(u) or is_p(u)
require is_ego(u) if u.position.x < 5 else is_p(u)
"""
    for item in scenario(text).sample(10, seed=2):
        ego, p, a = item.objects
        assert a.leader() is ego is item.egoObject
        assert a.other() is p
        assert item.params["u"] in (ego, p)


def test_objects_as_keys_are_those_of_the_scene() -> None:
    text = "x = Range(0, 1)\nego = new Object\np = new Object at (9, 9), with d {ego: 1, 'k': 2}\nparam d = {p: x}"
    made = scene(text)
    assert made.objects[1].d == {made.egoObject: 1, "k": 2}
    assert list(made.params["d"]) == [made.objects[1]]


def test_members_in_a_simulation_read_and_write_the_names_of_the_simulation() -> None:
    program = scenario("""
r = Range(1, 2)
count = 0
class A:
    @property
    def reading(self): return (r, count)
    @staticmethod
    def raise_count():
        global count
        count += 1
        return r
    @classmethod
    def twice(cls): return cls.raise_count() + cls.raise_count()
    def __len__(self): return count
monitor M():
    while True:
        assert p.twice() == 2 * r
        assert p.reading == (r, count)
        wait
ego = new Object
p = new A at (9, 9)
require monitor M()
record (p.reading, len(p)) as readings
param r = r
""")
    for item in program.sample(2, seed=4):
        r = item.params["r"]
        done = DummySimulator().simulate(item, maxSteps=3)
        assert done is not None
        found = [value for _, value in done.records["readings"]]
        counts = [count for _, count in found]
        assert found == [((r, count), count) for count in counts]
        assert [after - before for before, after in pairwise(counts)] == [2, 2, 2]
        assert item.objects[1].reading == (r, 0)


def test_simulators_ask_members_for_the_values_of_the_simulation() -> None:
    """Those of objects of the scene and of those that enter later, although no code of the program is running."""
    program = scenario("""
r = Range(1, 2)
count = 0
class A:
    sizes = [r]
    @property
    def reading(self): return (r, count)
    def plain(self): return (r, count)
    @staticmethod
    def fixed(): return (r, count)
    def __len__(self): return count
behavior B():
    global count
    while True:
        count += 1
        take 1
param r = r
scenario Main():
    setup:
        ego = new A with behavior B
    compose:
        wait
        do Sub()
scenario Sub():
    setup:
        new A at (9, 9)
    compose:
        while True:
            wait
""")

    class Asking(DummySimulation):
        def step(self) -> None:
            for thing in self.objects:
                wanted = (self.scene.params["r"], self.currentTime + 1)
                assert thing.reading == thing.plain() == thing.fixed() == wanted
                assert (thing.sizes, len(thing)) == ([wanted[0]], wanted[1])
            asked.append(len(self.objects))

    for item in program.sample(2, seed=4):
        asked: list[int] = []
        Asking(item, maxSteps=3, name="x", timestep=1)
        assert asked == [1, 2, 2]
        assert item.objects[0].reading == (item.params["r"], 0)


def test_scenes_with_such_members_are_whole_values() -> None:
    item = scene(f"{CLASSES}ego = new D at (5, 5)")
    assert pickle.loads(pickle.dumps(item)).objects[-1].position == item.objects[-1].position


def test_what_a_class_holds_is_that_of_the_sample_whatever_it_is() -> None:
    """An object, a draw, a tuple of them; but nothing that is no member."""
    text = (
        "import abc\nr = Range(1, 2)\no = new Object at (30, r)\n"
        "class A:\n    friend = o\n    drawn = r\n    pair = (o, r)\n    nested = ((o,), [r])\n    known = 7\n    __private__ = 3\n"
        "class B(A): pass\n"
        "def held(): return A.friend.y == A.drawn == A.pair[1] == A.pair[0].y == B.nested[1][0] == B.friend.y and A.drawn > 1.3\n"
        "require held()\nego = new B\nparam r = r\n"
    )
    for found in scenario(text).sample(4, seed=1):
        ego, other = found.egoObject, found.objects[1]
        r = found.params["r"]
        assert ego.friend is ego.pair[0] is ego.nested[0][0] is other
        assert ego.drawn == ego.pair[1] == ego.nested[1][0] == other.y == r > 1.3
        assert (ego.known, ego.__private__) == (7, 3)


def test_a_class_may_say_itself_how_attributes_are_looked_up() -> None:
    text = (
        "r = Range(1, 2)\nclass A:\n    tag: 3\n    def __getattribute__(self, name):\n"
        "        return 'own' if name == 'special' else super().__getattribute__(name)\n    def plain(self): return (r, self.special)\n"
        "ego = new A at (r, 0)\nrequire ego.plain() == (r, 'own') and ego.special == 'own'\nparam r = r\n"
    )
    for found in scenario(text).sample(2, seed=1):
        ego = found.egoObject
        assert ego.plain() == (found.params["r"], "own")
        assert (ego.special, ego.tag, ego.x) == ("own", 3, found.params["r"])


@pytest.mark.parametrize("between", [[], ["M"], ["M", "N"]])
def test_classes_from_which_those_of_objects_derive_are_one_in_all_samples(between: list[str]) -> None:
    """However far below them, and although their methods read what is drawn."""
    text = "r = Range(1, 2)\nclass K(object):\n    def f(self): return r\n"
    for name, base in zip(between, ["K", *between], strict=False):
        text += f"class {name}({base}): pass\n"
    text += (
        f"class A({['K', *between][-1]}, Object): pass\nego = new A\ndef told(): return isinstance(ego, K) and isinstance(ego, A) and r > 1.3\n"
        "require told()\nparam K = K, A = A, r = r\n"
    )
    for found in scenario(text).sample(3, seed=1):
        assert isinstance(found.egoObject, found.params["K"])
        assert type(found.egoObject) is found.params["A"]
        assert found.params["r"] > 1.3


MIXED = """
limit = Range(0, 1)
class Plain(object):
    held = [limit]
    def high(self): return limit > 0.5
    @property
    def level(self): return limit
    @staticmethod
    def fixed(): return limit < 2
    @classmethod
    def named(cls): return (cls.__name__, limit)
class Deeper(Plain):
    def twice(self): return self.level * 2
class Car(Object, Deeper):
    def high(self): return super().high() and self.twice() > 1
ego = new Car at (limit, 0)
alone = Plain()
alone.own = [limit]
"""


def test_methods_of_plain_classes_that_objects_derive_from_see_what_is_sampled() -> None:
    text = MIXED + (
        "require ego.high() and ego.level > 0.5 and ego.fixed() and Car.fixed()\n"
        "require ego.named() == ('Car', ego.position.x) and ego.held[0] == ego.position.x\n"
        "require alone.high() and alone.level == alone.own[0] == ego.position.x\nparam limit = limit\n"
        "record (ego.level, ego.high(), ego.twice(), ego.named()[1]) as seen\n"
    )
    for item in scenario(text).sample(8, seed=1):
        limit = item.params["limit"]
        assert limit > 0.5
        assert (item.egoObject.level, item.egoObject.twice(), item.egoObject.held) == (
            limit,
            2 * limit,
            [limit],
        )
        assert item.egoObject.named() == ("Car", limit)
        done = DummySimulator().simulate(item, maxSteps=1)
        assert done is not None
        assert [row for _, row in done.records["seen"]] == [(limit, True, 2 * limit, limit)] * 2


def test_plain_instances_may_lead_back_to_themselves() -> None:
    text = (
        "limit = Range(0, 1)\nclass Part(object):\n    def __init__(self, whole): self.whole, self.own = whole, limit\n"
        "    def high(self): return limit > 0.5 and self.own == limit\n"
        "whole = Part(None)\nwhole.parts = [Part(whole), Part(whole)]\nwhole.whole = whole\n"
        "ego = new Object at (limit, 0)\nparam limit = limit, whole = whole\n"
        "require all(part.high() and part.whole is whole for part in whole.parts) and whole.whole is whole\n"
    )
    for item in scenario(text).sample(5, seed=1):
        whole, limit = item.params["whole"], item.params["limit"]
        assert whole.whole is whole
        assert [(part.whole is whole, part.own) for part in whole.parts] == [(True, limit)] * 2
        assert whole.own == limit > 0.5
