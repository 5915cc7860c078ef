"""Signatures of the definitions of a project: parameters with their defaults, as written."""

import ast
from dataclasses import field
from typing import Any

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.classes import Classes
from scenic.compiler.semantics.modules import Module, Modules
from scenic.compiler.semantics.symbols import Symbol, SymbolKind
from scenic.dataclass import dataclass
from scenic.language.names import NAMES

__all__ = ["Parameter", "Signature", "signature_of"]


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter: ``default`` and ``annotation`` as written; ``prefix`` is ``*`` or ``**`` of those that collect."""

    name: str
    default: str | None = None
    annotation: str | None = None
    prefix: str = ""
    keyword_only: bool = False
    positional_only: bool = False

    @property
    def required(self) -> bool:
        """Return whether every call must give it."""
        return self.default is None and not self.prefix

    def __str__(self) -> str:
        text = f"{self.prefix}{self.name}"
        if self.annotation is not None:
            text += f": {self.annotation}"
        if self.default is not None:
            text += f" = {self.default}" if self.annotation is not None else f"={self.default}"
        return text


@dataclass(frozen=True, slots=True)
class Signature:
    """A signature. ``parameters`` are without ``self`` for methods and classes."""

    name: str
    parameters: tuple[Parameter, ...]
    returns: str | None = None
    documentation: str | None = field(default=None, compare=False)

    def __str__(self) -> str:
        words: list[str] = []
        for index, parameter in enumerate(self.parameters):
            before = self.parameters[index - 1] if index else None
            if before is not None and before.positional_only and not parameter.positional_only:
                words.append("/")
            if (
                parameter.keyword_only
                and not parameter.prefix
                and not (before is not None and (before.keyword_only or before.prefix == "*"))
            ):
                words.append("*")
            words.append(str(parameter))
        if self.parameters and self.parameters[-1].positional_only:
            words.append("/")
        text = f"{self.name}({', '.join(words)})"
        return text if self.returns is None else f"{text} -> {self.returns}"


def signature_of(modules: Modules, symbol: Symbol) -> Signature | None:
    """Return the signature of a symbol; ``None`` if it cannot be called, or its signature is not known."""
    if symbol.is_builtin:
        declaration = NAMES.get(symbol.name)
        if declaration is None or "(" not in declaration.signature:
            return None
        return _declared(declaration.signature, declaration.documentation)
    node: Any = symbol.node
    module = symbol.module
    if module is None:
        return None
    match node:
        case ast.FunctionDef() | ast.AsyncFunctionDef():
            skip = symbol.kind is SymbolKind.METHOD and not _is_static(node)
            returns = None if node.returns is None else module.text(node.returns)
            return _signature(module, symbol, node.args, skip=int(skip), returns=returns)
        case scenic.BehaviorDef() | scenic.MonitorDef():
            return _signature(module, symbol, node.args)
        case scenic.ScenarioDef():
            return (
                Signature(symbol.name, (), None, symbol.documentation)
                if node.args is None
                else _signature(module, symbol, node.args)
            )
        case ast.ClassDef():
            return _of_class(modules, symbol, node)
    return None


def _of_class(modules: Modules, symbol: Symbol, node: ast.ClassDef) -> Signature | None:
    class_here = Classes(modules).of_symbol(symbol)
    if class_here is None or class_here.is_scenic:
        return None
    initial = next((member for member in class_here.members if member.name == "__init__"), None)
    if initial is not None and initial.symbol is not None:
        initial_signature = signature_of(modules, initial.symbol)
        return (
            None
            if initial_signature is None
            else Signature(symbol.name, initial_signature.parameters, None, symbol.documentation)
        )
    if not class_here.complete or node.decorator_list or node.keywords:
        return None
    return Signature(symbol.name, (), None, symbol.documentation)


def _is_static(node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    return any(isinstance(each, ast.Name) and each.id == "staticmethod" for each in node.decorator_list)


def _signature(
    module: Module, symbol: Symbol, args: ast.arguments, *, skip: int = 0, returns: str | None = None
) -> Signature:
    def parameter(arg: ast.arg, default: ast.expr | None, **more: Any) -> Parameter:
        annotation = None if arg.annotation is None else module.text(arg.annotation)
        return Parameter(arg.arg, None if default is None else module.text(default), annotation, **more)

    positional = [*args.posonlyargs, *args.args]
    defaults: list[ast.expr | None] = [None] * (len(positional) - len(args.defaults))
    defaults += args.defaults
    parameters = [
        parameter(arg, default, positional_only=index < len(args.posonlyargs))
        for index, (arg, default) in enumerate(zip(positional, defaults, strict=True))
    ][skip:]
    if args.vararg is not None:
        parameters.append(parameter(args.vararg, None, prefix="*"))
    parameters += [
        parameter(arg, default, keyword_only=True)
        for arg, default in zip(args.kwonlyargs, args.kw_defaults, strict=False)
    ]
    if args.kwarg is not None:
        parameters.append(parameter(args.kwarg, None, prefix="**"))
    return Signature(symbol.name, tuple(parameters), returns, symbol.documentation)


def _declared(text: str, documentation: str) -> Signature:
    """Return the signature of a declaration such as ``DiscreteRange(low, high, weights=None)``."""
    name, _, inside = text.removesuffix(")").partition("(")
    parameters: list[Parameter] = []
    for part in _split(inside):
        if part == "...":
            last = parameters.pop() if parameters else Parameter("values")
            parameters += [
                last,
                Parameter(f"more_{last.name}s" if last.name == "value" else "others", prefix="*"),
            ]
        elif part == "*":
            continue
        else:
            word, _, default = part.partition("=")
            stars = len(word) - len(word.lstrip("*"))
            parameters.append(Parameter(word.strip("* "), default or None, None, "*" * stars))
    return Signature(name, tuple(parameters), None, documentation)


def _split(text: str) -> list[str]:
    """Return the parts between the commas that stand in no brackets."""
    parts, depth, start = [], 0, 0
    for index, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if character == "," and not depth:
            parts.append(text[start:index].strip())
            start = index + 1
    parts.append(text[start:].strip())
    return [part for part in parts if part]
