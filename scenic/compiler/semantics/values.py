"""The values of expressions: their kinds and classes, as far as the text of a program and of its modules shows them.

A value is inferred from literals, from calls of what the language provides, from operators, from definitions and annotations, and
through names all of whose values the text shows. Its kind is certain, or nothing is said of it; its class is the likely one.
"""

import ast
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, NamedTuple

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Binding, BindingKind, Scope, ScopeKind
from scenic.compiler.semantics import kinds
from scenic.compiler.semantics.classes import LIBRARY, Class, Classes, is_of_library
from scenic.compiler.semantics.kinds import SEQUENCES, ValueKind, joint, kind_of_type
from scenic.compiler.semantics.modules import Exported, FoundModule, Module
from scenic.compiler.semantics.symbols import (
    Symbol,
    SymbolKind,
    builtin_symbol,
    symbol_of_binding,
)
from scenic.language.members import INSTANCE_METHODS, MEMBERS, members_of
from scenic.language.members import Member as DeclaredMember
from scenic.language.names import NAMES, NameKind
from scenic.language.operators import OPERATORS
from scenic.language.properties import attributes_of, properties_of
from scenic.language.types import INSTANCES

__all__ = ["Value", "Values"]

_DEEPEST: Final = 40
"""Steps from an expression to what it is, through names, calls and attributes, after which nothing is known."""
_MOST_PARTS: Final = 64
"""Number of elements of a tuple or list that are examined."""

_MADE_BY_CALLS: Final = (NameKind.SHAPE, NameKind.REGION, NameKind.DISTRIBUTION)
"""Names that stand for a value only when they are called."""
_RUN: Final[Mapping[SymbolKind, str]] = MappingProxyType(
    {each: each.value for each in (SymbolKind.BEHAVIOR, SymbolKind.MONITOR, SymbolKind.SCENARIO)}
)
"""The kinds of values that calls of definitions make, by the kind of the definition."""
_SEQUENCE_TYPES: Final = frozenset(
    {"tuple", "list", "Sequence", "Iterable", "Iterator", "Collection", "frozenset", "set"}
)
"""Types whose values hold others of one type."""
_SAME_SEQUENCE: Final = frozenset({"list", "tuple", "sorted", "reversed", "set"})
"""Functions that give the elements of their first argument again."""
_BY_PROVIDED: Final = MappingProxyType(
    {"Workspace": kinds.WORKSPACE, "str": kinds.TEXT, "localPath": kinds.TEXT, "range": kinds.RANGE}
)
_ANNOTATIONS: Final = MappingProxyType(
    {
        "int": kinds.NUMBER,
        "float": kinds.NUMBER,
        "str": kinds.TEXT,
        "Vector": kinds.VECTOR,
        "Orientation": kinds.ORIENTATION,
        "VectorField": kinds.FIELD,
    }
)
_CLASS_OF_KIND: Final = MappingProxyType({"point": "Point", "oriented point": "OrientedPoint"})
_KIND_OF_CLASS: Final = MappingProxyType({cls: kind for kind, cls in _CLASS_OF_KIND.items()})
_DECLARED: Final[Mapping[str, str]] = MappingProxyType(
    {
        each.home: each.result.name
        for each in NAMES.values()
        if each.home is not None
        and each.result is not None
        and each.kind in (NameKind.CLASS, NameKind.REGION, NameKind.SHAPE)
    }
)
"""The types of the instances of classes of the language, by the place of the class."""
_MOST_BASES: Final = 20


class Value(NamedTuple):
    """A value, as far as it is known: its certain kind, its likely class, and the likely class of the elements of a sequence."""

    kind: ValueKind | None = None
    cls: Symbol | None = None
    elements: Symbol | None = None

    @property
    def element(self) -> "Value":
        """An element of a sequence, as a loop takes it."""
        kind = self.kind
        return Value(kind.items if kind is not None and kind.name in SEQUENCES else None, self.elements)


_UNKNOWN: Final = Value()
_NUMBER: Final = Value(kinds.NUMBER)
_FUNCTION: Final = Value(kinds.FUNCTION)
_CONSTANTS: Final[Mapping[type, Value]] = MappingProxyType(
    {
        bool: Value(kinds.BOOLEAN),
        float: _NUMBER,
        int: _NUMBER,
        str: Value(kinds.TEXT),
        type(None): Value(kinds.NOTHING),
    }
)
"""The values of constants in the text."""


class Values:
    """Infers the values of the expressions of a program and of its modules; keeps what it has inferred."""

    def __init__(self, classes: Classes) -> None:
        self._classes: Final = classes
        self._modules: Final = classes.modules
        self._values: Final[dict[ast.expr, Value]] = {}
        self._named_classes: Final[dict[ast.expr, Class | None]] = {}
        self._meanings: Final[dict[ast.expr, Symbol | None]] = {}
        self._bindings: Final[dict[Binding | Module, Value]] = {}
        """The values of names by their bindings, and those of the egos of modules."""

    def value(self, module: Module, node: ast.expr, depth: int = 0) -> Value:
        """Return the value of an expression."""
        if depth > _DEEPEST:
            return _UNKNOWN
        result = self._values.get(node)
        if result is None:
            self._values[node] = _UNKNOWN  # A name that is bound to itself.
            infer = _INFERENCES.get(node.__class__)
            result = _UNKNOWN if infer is None else infer(self, module, node, depth + 1)
            self._values[node] = result
        return result

    def meaning(self, module: Module, node: ast.expr, depth: int = 0) -> Symbol | None:
        """The meaning of a name or an attribute of a program; ``None`` if it is unknown."""
        if depth > _DEEPEST or not isinstance(node, ast.Name | ast.Attribute):
            return None
        if node not in self._meanings:
            self._meanings[node] = None
            self._meanings[node] = self._meaning(module, node, depth + 1)
        return self._meanings[node]

    def of_exported(self, exported: Exported, depth: int = 0) -> Value:
        """Return the value that a module defines under a name."""
        target = self._modules.follow(exported)
        if isinstance(target, FoundModule) or target.module is None or target.binding is None:
            return _UNKNOWN
        if target.binding.kinds == {BindingKind.IMPORTED}:
            return _UNKNOWN  # From where nobody knows.
        return self._of_binding(target.module, target.binding, depth + 1)

    # Meanings

    def _meaning(self, module: Module, node: ast.Name | ast.Attribute, depth: int) -> Symbol | None:
        symbol = self._classes.names(module).name_meaning(node)
        if symbol is not None or isinstance(node, ast.Name):
            return symbol
        owner = self.meaning(module, node.value, depth)
        if owner is None or owner.kind is not SymbolKind.CLASS:
            owner = self.value(module, node.value, depth).cls
        cls = self._classes.of_symbol(owner)
        member = None if cls is None else cls.member(node.attr)
        if member is None:
            return None
        return member.symbol or Symbol(member.name, member.kind, container=member.owner)

    # Expressions

    def _sequence(self, module: Module, node: ast.Tuple | ast.List, depth: int) -> Value:
        """The value of a tuple or list in the text."""
        name = "tuple" if isinstance(node, ast.Tuple) else "list"
        parts = node.elts
        if any(isinstance(part, ast.Starred) for part in parts):
            return Value(ValueKind(name))
        values = [self.value(module, part, depth) for part in parts[:_MOST_PARTS]]
        common = _common(values) if len(parts) <= _MOST_PARTS else _UNKNOWN
        item_kinds = (value.kind for value in values)
        odd = next((each for each in item_kinds if each is not None and each.name not in kinds.NUMBERS), None)
        return Value(ValueKind(name, len(parts), items=common.kind, odd=odd), elements=common.cls)

    def _list_comprehension(self, module: Module, node: ast.ListComp, depth: int) -> Value:
        element = self.value(module, node.elt, depth)
        return Value(ValueKind("list", items=element.kind), elements=element.cls)

    def _dictionary(self, module: Module, node: ast.Dict, depth: int) -> Value:
        items = joint([self.value(module, each, depth).kind for each in node.values])
        return Value(ValueKind("dictionary", items=items))

    def _dictionary_comprehension(self, module: Module, node: ast.DictComp, depth: int) -> Value:
        return Value(ValueKind("dictionary", items=self.value(module, node.value, depth).kind))

    def _instance(self, module: Module, node: scenic.New, depth: int) -> Value:
        known = self.class_of_objects(module, node.cls)
        meant = self.meaning(module, node.cls, depth) if known is None else known.symbol
        return Value(_kind_of_instances(known), _if_class(meant))

    def _conditional(self, module: Module, node: ast.IfExp, depth: int) -> Value:
        return self._alike(module, (node.body, node.orelse), depth)

    def _attribute(self, module: Module, node: ast.Attribute, depth: int) -> Value:
        meant = self.meaning(module, node, depth)
        likely = _UNKNOWN if meant is None else self._annotated_symbol(meant, depth, called=False)
        return Value(self._kind_of_attribute(module, node, depth), likely.cls, likely.elements)

    def _unary(self, module: Module, node: ast.UnaryOp, depth: int) -> Value:
        if isinstance(node.op, ast.Not):
            return Value(kinds.BOOLEAN)
        return _NUMBER if self.value(module, node.operand, depth).kind == kinds.NUMBER else _UNKNOWN

    def _arithmetic(self, module: Module, node: ast.BinOp, depth: int) -> Value:
        left = self.value(module, node.left, depth).kind
        return Value(_binary(left, self.value(module, node.right, depth).kind, node.op))

    def _operation(self, module: Module, node: scenic.Operation, depth: int) -> Value:
        if node.operator == "deg" and node.operands[0] is not None:
            return Value(self.value(module, node.operands[0], depth).kind)
        return (
            Value(kind_of_type(OPERATORS[node.operator].result)) if node.operator in OPERATORS else _UNKNOWN
        )

    def class_of_objects(self, module: Module, name: ast.expr) -> Class | None:
        """Return the class that an expression certainly names, if it may make objects of the scene."""
        if name not in self._named_classes:
            self._named_classes[name] = self._class_of_objects(module, name)
        return self._named_classes[name]

    def _class_of_objects(self, module: Module, name: ast.expr) -> Class | None:
        names = self._classes.names(module)
        provided = names.provided(name)
        symbol = names.definition(name) if provided is None else Symbol(provided, SymbolKind.CLASS)
        known = self._classes.of_symbol(symbol)
        return known if known is not None and known.is_scenic else None

    def _alike(self, module: Module, options: Iterable[ast.expr], depth: int) -> Value:
        return _common([self.value(module, option, depth) for option in options])

    def _item(self, module: Module, node: ast.Subscript, depth: int) -> Value:
        owner = self.value(module, node.value, depth)
        kind = owner.kind
        if isinstance(node.slice, ast.Slice):
            return Value(elements=owner.elements)
        if kind == kinds.VECTOR:
            return Value(kinds.NUMBER)
        items = kind.items if kind is not None and kind.name in (*SEQUENCES, "dictionary") else None
        return Value(items, owner.elements)

    # Calls

    def _call(self, module: Module, node: ast.Call, depth: int) -> Value:
        function = node.func
        method = self.method(module, function, depth) if isinstance(function, ast.Attribute) else None
        if method is not None:
            return Value(None if method.result is None else kind_of_type(method.result.name))
        names = self._classes.names(module)
        provided_name = names.likely_provided(function)
        if provided_name is not None:
            value = self._call_of_provided(module, provided_name, node, depth)
            return value if names.provided(function) else Value(None, value.cls, value.elements)
        definition = names.definition(function)
        kind, likely = None, _UNKNOWN
        if definition is not None and definition.kind in _RUN:
            kind = ValueKind(_RUN[definition.kind])
        elif definition is not None and definition.module is not None and definition.node is not None:
            home = definition.module
            results = self._classes.names(home).returned(definition.node)
            likely = self._alike(home, results, depth) if results else _UNKNOWN
            kind = likely.kind
        meaning = definition or self.meaning(module, function, depth)
        if meaning is not None and meaning.kind is SymbolKind.CLASS:
            return Value(kind, meaning)
        annotation = _UNKNOWN if meaning is None else self._annotated_symbol(meaning, depth, called=True)
        return Value(kind, annotation.cls or likely.cls, annotation.elements or likely.elements)

    def _call_of_provided(self, module: Module, name: str, node: ast.Call, depth: int) -> Value:
        """The value of a call of what the language provides under a name."""
        arguments = node.args
        if name == "filter" and len(arguments) == 2:
            return Value(elements=self.value(module, arguments[1], depth).elements)
        if name in _SAME_SEQUENCE and len(arguments) == 1:
            return Value(elements=self.value(module, arguments[0], depth).elements)
        if name not in NAMES:
            return _UNKNOWN
        result, cls = NAMES[name].result, _if_class(builtin_symbol(name))
        if result is not None:
            return Value(kind_of_type(result.name), cls)
        if name in ("abs", "round", "min", "max"):
            values = [self.value(module, each, depth) for each in arguments]
            numbers = values and all(each.kind == kinds.NUMBER for each in values)
            return Value(kinds.NUMBER) if numbers else _UNKNOWN
        if name in ("Uniform", "Options", "Discrete") and not node.keywords:
            return _common([self._option(module, each, node, depth) for each in _options(node)])
        return Value(_BY_PROVIDED.get(name), cls)

    def _option(self, module: Module, option: ast.expr, choice: ast.Call, depth: int) -> Value:
        """Return the value of an option of a choice; of ``*values`` that of the elements."""
        if option is choice:
            return _UNKNOWN
        if not isinstance(option, ast.Starred):
            return self.value(module, option, depth)
        return self.value(module, option.value, depth).element

    def method(self, module: Module, function: ast.Attribute, depth: int = 0) -> DeclaredMember | None:
        """Return the declared method that a call of an attribute calls."""
        names = self._classes.names(module)
        owner = self.value(module, function.value, depth).kind
        if owner is None:
            if names.provided(function.value) == "Orientation":
                return MEMBERS["orientation"].get(function.attr) if function.attr.startswith("from") else None
            return None
        if owner.name in INSTANCES:
            return None if function.attr in names.owners else INSTANCE_METHODS.get(function.attr)
        member = members_of(owner.name).get(function.attr)
        return member if member is not None and member.is_method else None

    # Attributes

    def _kind_of_attribute(self, module: Module, node: ast.Attribute, depth: int) -> ValueKind | None:
        owner = self.value(module, node.value, depth).kind
        if owner is None:
            return None
        if owner.name not in INSTANCES:
            member = members_of(owner.name).get(node.attr)
            if member is None or member.is_method or member.result is None:
                return None
            return kind_of_type(member.result.name)
        cls = _CLASS_OF_KIND.get(owner.name, "Object")
        property_declaration = properties_of(cls).get(node.attr)
        if property_declaration is not None:
            return kind_of_type(property_declaration.type)
        attribute = attributes_of(cls).get(node.attr)
        return None if attribute is None or attribute.is_method else kind_of_type(attribute.type)

    # Names

    def _name(self, module: Module, node: ast.Name, depth: int) -> Value:
        names = self._classes.names(module)
        binding = names.binding(node)
        if binding is None:
            return self._unbound(module, node, depth)
        definition = names.definition(node)
        kind = None if definition is None else self._of_definition(definition)
        if kind is not None or binding.kinds <= {BindingKind.FUNCTION, BindingKind.CLASS}:
            return Value(kind)
        value = self._of_binding(module, binding, depth)
        return Value(None if names.is_hidden(binding) else value.kind, value.cls, value.elements)

    def _of_definition(self, definition: Symbol) -> ValueKind | None:
        """Return the kind of a function, behavior, ... or class of objects itself."""
        if definition.kind is SymbolKind.CLASS:
            cls = self._classes.of_symbol(definition)
            return kinds.CLASS if cls is not None and cls.complete and cls.is_scenic else None
        is_async = isinstance(definition.node, ast.AsyncFunctionDef)
        word = "function" if definition.kind is SymbolKind.METHOD else definition.kind.value
        return None if is_async else ValueKind(word)

    def _unbound(self, module: Module, node: ast.Name, depth: int) -> Value:
        """The value of a name that the text binds nowhere in reach."""
        names = self._classes.names(module)
        if node.id == "ego":
            return self._ego(module, node, depth)
        provided_name = names.provided(node)
        if provided_name in ("everywhere", "nowhere"):
            return Value(kinds.REGION)
        if provided_name is not None:
            name_kind = NAMES[provided_name].kind if provided_name in NAMES else None
            if name_kind is NameKind.FUNCTION:
                return _FUNCTION
            return Value(kinds.CLASS if name_kind in _MADE_BY_CALLS else None)
        import_target = names.brought.get(node.id)
        if import_target is None:
            return _UNKNOWN
        definition = names.definition(node)
        if definition is not None:
            return Value(self._of_definition(definition))
        value = self.of_exported(import_target, depth)
        certain = not names.wildcard and not names.resolution.reflective
        return Value(self._kind_of_class(value.cls) if certain else None, value.cls, value.elements)

    def _ego(self, module: Module, node: ast.Name, depth: int) -> Value:
        """Return the value of the ego: one of the objects that the program makes it."""
        likely = self._bindings.get(module)
        if likely is None:
            self._bindings[module] = Value(ValueKind("object"))
            likely = self._bindings[module] = self._likely_ego(module, depth)
        if self._classes.names(module).provided(node) != "ego":
            return Value(None, likely.cls)
        return likely

    def _likely_ego(self, module: Module, depth: int) -> Value:
        names = self._classes.names(module)
        uses = module.resolution.uses.get("ego", ())
        stores = [use.node for use in uses if isinstance(use.node.ctx, ast.Store)]
        values = [names.assigned.get(each) for each in stores]
        known = [each for each in values if each is not None]
        likely = self._alike(module, known, depth) if known else _UNKNOWN
        one = known[0] if len(known) == len(stores) == 1 else None
        members = likely.kind.members if isinstance(one, scenic.New) and likely.kind is not None else None
        return Value(ValueKind("object", members=members), likely.cls)

    def _of_binding(self, module: Module, binding: Binding, depth: int) -> Value:
        """The value of a name, whatever it may be elsewhere."""
        if depth > _DEEPEST:
            return _UNKNOWN
        known = self._bindings.get(binding)
        if known is None:
            self._bindings[binding] = _UNKNOWN
            known = self._bindings[binding] = self._bound_value(module, binding, depth)
        return known

    def _bound_value(self, module: Module, binding: Binding, depth: int) -> Value:
        if binding.kinds == {BindingKind.SELF} or binding.kinds == {BindingKind.PARAMETER}:
            return self._parameter(module, binding, depth)
        if binding.kinds == {BindingKind.IMPORTED}:
            value = self.of_exported(Exported(binding.name, module, binding), depth)
            return Value(None, value.cls, value.elements)
        names = self._classes.names(module)
        values = names.values(binding)
        if not values:
            return _UNKNOWN
        return _common([self._bound(module, binding.name, *each, depth) for each in values])

    def _bound(self, module: Module, name: str, value: ast.expr, in_turn: bool, depth: int) -> Value:
        """The value of a name that an expression is bound to, or whose parts the name runs through in turn."""
        names = self._classes.names(module)
        whole = self.value(module, value, depth)
        if in_turn:
            is_range = isinstance(value, ast.Call) and names.provided(value.func) == "range"
            return Value(kinds.NUMBER) if is_range else whole.element
        kind = whole.kind
        if kind is not None and kind.name in ("list", "dictionary"):
            # Lists grow, and so do those in them.
            items = None if name in names.grown else kind.items
            is_open = items is not None and items.name in ("list", "dictionary")
            kind = ValueKind(
                kind.name, items=ValueKind(items.name) if items is not None and is_open else items
            )
        return Value(kind, whole.cls, whole.elements)

    def _parameter(self, module: Module, binding: Binding, depth: int) -> Value:
        [site, *others] = binding.sites
        if isinstance(site, ast.arg) and not others:
            run = module.loop_of.get(site)
            if run is not None:
                return Value(None, self.value(module, run, depth).elements)
            if site.annotation is not None:
                annotation = self._annotated(module, site.annotation, depth)
                is_examined = binding.name in self._classes.names(module).examined
                kind = None if is_examined else self._kind_of_annotation(module, site.annotation)
                return Value(kind, annotation.cls, annotation.elements)
        return Value(None, _class_of_self(module, binding.scope, binding.name))

    # Annotations

    def _kind_of_annotation(self, module: Module, annotation: ast.expr) -> ValueKind | None:
        name = self._classes.names(module).provided(annotation)
        if name is not None and name in _ANNOTATIONS:
            return _ANNOTATIONS[name]
        known = self.class_of_objects(module, annotation)
        return None if known is None or known.names is None else _kind_of_instances(known)

    def _annotated_symbol(self, symbol: Symbol, depth: int, *, called: bool) -> Value:
        """Return the value of what a symbol means, or of a call of it, by its annotation."""
        node, home = symbol.node, symbol.module
        if home is None or node is None:
            return _UNKNOWN
        if isinstance(node, ast.FunctionDef):
            is_property = any(
                _last_word(item) in ("property", "cached_property") for item in node.decorator_list
            )
            annotation = node.returns if is_property != called else None
        else:
            annotation = None if called else home.annotation_of.get(node)
        return _UNKNOWN if annotation is None else self._annotated(home, annotation, depth + 1)

    def _annotated(self, module: Module, annotation: ast.expr, depth: int) -> Value:
        """Return the class that an annotation of a module names, of a value or its elements; ``None`` beside a class counts for nothing."""
        if depth > _DEEPEST:
            return _UNKNOWN
        match annotation:
            case ast.Constant(value=str() as text):
                try:
                    inner = ast.parse(text, mode="eval").body
                except (SyntaxError, ValueError, RecursionError):
                    return _UNKNOWN
                return self._annotated(module, inner, depth + 1)
            case ast.BinOp(left=left, op=ast.BitOr(), right=right):
                sides = [
                    self._annotated(module, side, depth + 1)
                    for side in (left, right)
                    if not (isinstance(side, ast.Constant) and side.value is None)
                ]
                return sides[0] if len(sides) == 1 else _UNKNOWN
            case ast.Subscript(value=value, slice=inner) if _last_word(value) in _SEQUENCE_TYPES:
                first = inner.elts[0] if isinstance(inner, ast.Tuple) and inner.elts else inner
                return Value(elements=self._annotated(module, first, depth + 1).cls)
            case ast.Name(id=name):
                names = self._classes.names(module)
                target = names.at_top(name)
                symbol = None if target is None else names.symbol_of(target)
                return Value(cls=_if_class(symbol))
        return _UNKNOWN

    def _kind_of_class(self, symbol: Symbol | None) -> ValueKind | None:
        """Return the kind of the instances of a class of Python, if the language declares it for the class or a base."""
        waiting = [symbol]
        for _ in range(_MOST_BASES):
            cls = waiting.pop(0) if waiting else None
            if cls is None:
                return None
            if cls.filename is not None and is_of_library(cls.filename):
                home = cls.filename.removeprefix(LIBRARY).removesuffix(".py").replace(os.sep, ".")
                type_declared = _DECLARED.get(f"scenic.{home}:{cls.name}")
                if type_declared is not None:
                    return kind_of_type(type_declared)
            ancestor = self._classes.of_symbol(cls)
            waiting += () if ancestor is None else ancestor.bases
        return None


def _kind_of_instances(cls: Class | None) -> ValueKind:
    """Return the kind of what ``new`` makes of a class."""
    if cls is None:
        return ValueKind("object")
    return ValueKind(_KIND_OF_CLASS.get(cls.built_in or "", "object"), members=cls.names)


def _common(values: Sequence[Value]) -> Value:
    """Return the kind and classes that all of some values have."""
    if not values:
        return _UNKNOWN
    first = values[0]
    if values.count(first) == len(values):
        return first
    return Value(
        joint([each.kind for each in values]),
        first.cls if all(each.cls == first.cls for each in values) else None,
        first.elements if all(each.elements == first.elements for each in values) else None,
    )


def _if_class(symbol: Symbol | None) -> Symbol | None:
    return symbol if symbol is not None and symbol.kind is SymbolKind.CLASS else None


def _last_word(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def _class_of_self(module: Module, scope: Scope, name: str) -> Symbol | None:
    """Return the class in whose property default or method ``self`` stands."""
    owner = scope.parent
    if owner is None or owner.kind is not ScopeKind.CLASS:
        return None
    if scope.kind is not ScopeKind.PROPERTY:
        method: Any = scope.node
        args = getattr(method, "args", None)
        first = [*args.posonlyargs, *args.args][:1] if args is not None else []
        if not first or first[0].arg != name:
            return None
    binding = module.resolution.sites.get(owner.node)
    return None if binding is None else symbol_of_binding(module, binding)


def _binary(left: ValueKind | None, right: ValueKind | None, operator: ast.operator) -> ValueKind | None:
    """Return the kind of an arithmetic operation."""
    number, vector = kinds.NUMBER, kinds.VECTOR
    if left == number == right:
        return number
    if left == vector and right == number and isinstance(operator, ast.Mult | ast.Div):
        return vector
    if left == number and right == vector and isinstance(operator, ast.Mult):
        return vector
    return vector if left == vector == right and isinstance(operator, ast.Add | ast.Sub) else None


def _options(node: ast.Call) -> Iterator[ast.expr]:
    """Yield the options of a choice that the text shows; the call itself stands for unknown options."""
    name = node.func.id if isinstance(node.func, ast.Name) else ""
    if name == "Discrete" and not any(isinstance(each, ast.Dict) for each in node.args):
        yield node
        return
    of_sequence = name == "Options" and len(node.args) == 1
    for argument in node.args:
        if of_sequence and isinstance(argument, ast.List | ast.Tuple):
            yield from (node if isinstance(each, ast.Starred) else each for each in argument.elts)
        elif of_sequence and not isinstance(argument, ast.Dict):
            yield node
        elif isinstance(argument, ast.Dict):
            yield from (node if key is None else key for key in argument.keys)
        else:
            yield argument
    if not node.args:
        yield node


_INFERENCES: Final[Mapping[type[ast.AST], Callable[[Values, Module, Any, int], Value]]] = MappingProxyType(
    {
        ast.Attribute: Values._attribute,
        ast.BinOp: Values._arithmetic,
        ast.Call: Values._call,
        ast.Constant: lambda _values, _module, node, _depth: _CONSTANTS.get(type(node.value), _UNKNOWN),
        ast.Dict: Values._dictionary,
        ast.DictComp: Values._dictionary_comprehension,
        ast.IfExp: Values._conditional,
        ast.JoinedStr: lambda *_: Value(kinds.TEXT),
        ast.Lambda: lambda *_: Value(kinds.FUNCTION),
        ast.List: Values._sequence,
        ast.ListComp: Values._list_comprehension,
        ast.Name: Values._name,
        ast.Set: lambda *_: Value(ValueKind("set")),
        ast.SetComp: lambda *_: Value(ValueKind("set")),
        ast.Subscript: Values._item,
        ast.Tuple: Values._sequence,
        ast.UnaryOp: Values._unary,
        scenic.New: Values._instance,
        scenic.Operation: Values._operation,
    }
)
"""The ways to infer the values of expressions, by their classes; nothing is known of others."""
