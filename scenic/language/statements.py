"""The statements that Scenic adds, as data: what they are, and where they may stand (section 2 of the spec)."""

import re
from collections.abc import Mapping
from dataclasses import field
from enum import StrEnum
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.types import FIXED_NUMBER, PATTERN, SCALAR, Type

__all__ = ["STATEMENTS", "Effect", "Place", "Statement"]


class Place(StrEnum):
    """The place of a statement in a program.

    Functions and nested statements belong to the place they are written in.

    The values complete the sentence "... cannot be used ...".
    """

    TOP = "at the top level"
    SETUP = "in the setup of a scenario"
    COMPOSE = "in a compose block"
    BEHAVIOR = "in a behavior"
    MONITOR = "in a monitor"
    CLASS = "in the body of a class"


class Effect(StrEnum):
    """The ways in which a method of the prelude carries out a statement."""

    CALL = "call"
    """The call is all."""
    YIELD = "yield"
    """The running behavior, monitor or scenario yields the result to the simulation."""
    DELEGATE = "delegate"
    """The running behavior, monitor or scenario delegates to the result, a generator."""


_TOP_AND_SETUP: Final = frozenset({Place.TOP, Place.SETUP})
_DYNAMIC: Final = frozenset({Place.COMPOSE, Place.BEHAVIOR, Place.MONITOR})
_BLOCKS: Final = _TOP_AND_SETUP | _DYNAMIC


@dataclass(frozen=True, slots=True)
class Statement:
    """One statement.

    ``node`` is the name of its class in `scenic.compiler.tree`. ``available`` tells whether this version builds it
    outside behaviors; the bodies of behaviors are carried as data, so nothing in them is refused. ``suspends`` tells
    whether it acts on the running behavior, scenario or monitor itself, so that no function called by it can have it.

    ``effect`` and ``method`` say how generated code carries it out: by a method of the prelude
    (`scenic.runtime.program.prelude`), by default of the same name. The running instance comes first if the statement suspends;
    then the fields of the node: expressions as their values, those in ``later`` as functions without parameters, a list one after
    the other, a duration as number and unit; all others by name. A statement that needs more has a rule in
    `scenic.compiler.lowering`. ``takes`` are the types of which the values of some fields must have one.
    """

    node: str
    title: str
    forms: tuple[str, ...]
    places: frozenset[Place]
    documentation: str
    available: bool = True
    suspends: bool = False
    effect: Effect = Effect.CALL
    method: str = ""
    later: frozenset[str] = frozenset()
    takes: Mapping[str, tuple[Type, ...]] = field(default_factory=dict)

    @property
    def function(self) -> str:
        """The name of the method that carries it out."""
        return self.method or re.sub(r"(?<=[a-z])(?=[A-Z])", "_", self.node).lower()


_ALL = (
    Statement(
        "Model",
        "model",
        ("model module",),
        frozenset({Place.TOP}),
        "Uses a world model: all names that the module defines become available. A model given on the command "
        "line replaces it.",
    ),
    Statement(
        "Param",
        "param",
        ("param name = value, ...",),
        _TOP_AND_SETUP,
        "Sets global parameters, which are sampled with the scene. The command line overrides them.",
    ),
    Statement(
        "Simulator",
        "simulator",
        ("simulator value",),
        _TOP_AND_SETUP,
        "Selects the simulator of the scenes; evaluated only if scenes are simulated.",
        later=frozenset({"value"}),
    ),
    Statement(
        "Require",
        "require",
        ("require condition", "require[probability] condition", "require condition as name"),
        _BLOCKS,
        "Keeps only scenes in which the condition holds. With a probability p in brackets, the condition holds "
        "in at least that share of the scenes.",
    ),
    Statement(
        "RequireMonitor",
        "require monitor",
        ("require monitor value", "require monitor value as name"),
        _BLOCKS,
        "Runs a monitor alongside the simulation, which rejects it when one of its requirements fails.",
    ),
    Statement(
        "Record",
        "record",
        ("record value as name", "record initial value", "record final value"),
        _TOP_AND_SETUP,
        "Saves a value during simulations: at every step, at the start or at the end.",
        later=frozenset({"value"}),
        takes={"every": (FIXED_NUMBER,), "after": (FIXED_NUMBER,), "to": (PATTERN,)},
    ),
    Statement(
        "Mutate",
        "mutate",
        ("mutate", "mutate object, ... by scale"),
        _TOP_AND_SETUP,
        "Adds noise to the position and orientation of the named objects, or of all objects so far.",
        takes={"scale": (FIXED_NUMBER,)},
    ),
    Statement(
        "TerminateWhen",
        "terminate when",
        ("terminate when condition", "terminate simulation when condition"),
        _TOP_AND_SETUP,
        "Ends the scenario, or the whole simulation, as soon as the condition holds.",
        later=frozenset({"condition"}),
    ),
    Statement(
        "TerminateAfter",
        "terminate after",
        ("terminate after duration",),
        _TOP_AND_SETUP,
        "Ends the scenario after a number of seconds or steps. If there are several such statements, the "
        "earliest end counts.",
        takes={"duration": (FIXED_NUMBER,)},
    ),
    Statement(
        "Terminate",
        "terminate",
        ("terminate", "terminate simulation"),
        _DYNAMIC,
        "Ends the current scenario, or the whole simulation, now.",
        suspends=True,
        effect=Effect.YIELD,
    ),
    Statement(
        "Take",
        "take",
        ("take action, ...",),
        frozenset({Place.BEHAVIOR}),
        "Takes actions in this step of the simulation and waits for the next.",
        suspends=True,
        effect=Effect.YIELD,
    ),
    Statement(
        "Wait",
        "wait",
        ("wait",),
        _DYNAMIC,
        "Takes no action in this step of the simulation.",
        suspends=True,
        effect=Effect.YIELD,
        method="take",
    ),
    Statement(
        "WaitFor",
        "wait for",
        ("wait for duration",),
        _DYNAMIC,
        "Takes no action for a number of seconds or steps.",
        suspends=True,
        effect=Effect.DELEGATE,
        method="wait",
        takes={"duration": (SCALAR,)},
    ),
    Statement(
        "WaitUntil",
        "wait until",
        ("wait until condition",),
        _DYNAMIC,
        "Takes no action until the condition holds.",
        suspends=True,
    ),
    Statement(
        "Do",
        "do",
        (
            "do behavior",
            "do behavior for duration",
            "do behavior until condition",
            "do behavior, ...",
            "do scenario, ...",
        ),
        _DYNAMIC,
        "Runs a behavior or scenario until it ends, a time is over or a condition holds. Several scenarios, or several "
        "behaviors of one agent, run side by side: the agent takes the actions of all, in order.",
        suspends=True,
        takes={"duration": (SCALAR,)},
    ),
    Statement(
        "DoChoose",
        "do choose",
        ("do choose behavior, ...", "do choose {behavior: weight, ...}"),
        _DYNAMIC,
        "Runs one of several behaviors or scenarios, drawn at random among those whose guards allow it.",
        suspends=True,
        effect=Effect.DELEGATE,
    ),
    Statement(
        "DoShuffle",
        "do shuffle",
        ("do shuffle behavior, ...", "do shuffle {behavior: weight, ...}"),
        _DYNAMIC,
        "Runs several behaviors or scenarios one after the other in random order.",
        suspends=True,
        effect=Effect.DELEGATE,
    ),
    Statement(
        "TryInterrupt",
        "try ... interrupt when",
        ("try: ... interrupt when condition: ...",),
        _DYNAMIC,
        "Runs a block that handlers interrupt while their conditions hold; later handlers win.",
        suspends=True,
    ),
    Statement(
        "Abort",
        "abort",
        ("abort",),
        _DYNAMIC,
        "Ends the innermost enclosing try-interrupt statement.",
        suspends=True,
    ),
    Statement(
        "Override",
        "override",
        ("override object specifier, ...",),
        _DYNAMIC | {Place.SETUP},
        "Gives properties of an existing object new values until the scenario ends.",
    ),
    Statement(
        "BehaviorDef",
        "behavior",
        ("behavior name(parameters): ...",),
        _TOP_AND_SETUP,
        "Defines the actions of an agent during a simulation.",
    ),
    Statement(
        "MonitorDef",
        "monitor",
        ("monitor name(parameters): ...",),
        _TOP_AND_SETUP,
        "Defines a process that watches a simulation and can reject or end it.",
    ),
    Statement(
        "ScenarioDef",
        "scenario",
        ("scenario name(parameters): ...", "scenario name: setup: ... compose: ..."),
        _TOP_AND_SETUP,
        "Defines a scenario that can be chosen, or composed with others.",
    ),
    Statement(
        "Guard",
        "guard",
        ("precondition: condition", "invariant: condition"),
        frozenset({Place.BEHAVIOR, Place.SETUP}),
        "A condition of a behavior or scenario, before its other statements: a precondition must hold when it "
        "starts, an invariant whenever it continues.",
    ),
    Statement(
        "PropertyDef",
        "property definition",
        ("name: default", "name[additive]: default", "name[dynamic]: default", "name[final]: default"),
        frozenset({Place.CLASS}),
        "Defines a property of the class with its default, which is evaluated for each instance and may read "
        "other properties as `self.name`.",
    ),
)

STATEMENTS: Final[Mapping[str, Statement]] = MappingProxyType(
    {statement.node: statement for statement in _ALL}
)
"""Every statement by the name of its class in the tree."""
