"""The values a program computes with: numbers, vectors and orientations, definite or random.

A random value wraps a node of the value graph. Every function here takes definite and random values alike: with definite
operands an operation is evaluated at once, by the same reading that batches use; with a random one it becomes a node. So
the language's operators, vector methods and specifier formulas are each written once.

Each idea has its module, and stands on those before it: `randoms` and `definite` (the classes), `nodes` (values as nodes and
back), `choices` (option by option), `applying` (operations), `parts` (elements, attributes and calls of random values) and
`coercions` (what is taken for what). The methods of the classes need all of them: this module, through which others use
values, tells the classes.
"""

from scenic.runtime.values.access import (
    NOTHING,
    attribute,
    called,
    element,
    element_of,
    elements_of,
    holds_instances,
)
from scenic.runtime.values.applying import (
    apply,
    binary,
    fixed_batch,
    folded,
    operate,
    random_key,
    unary,
    uniform,
)
from scenic.runtime.values.choices import (
    IDENTITY,
    as_drawn,
    is_answered_by_code,
    is_choice_of_frozen,
    is_open,
    options_of,
    over_options,
    per_option,
    rejection,
    select,
)
from scenic.runtime.values.coercions import (
    to_heading,
    to_orientation,
    to_scalar,
    to_vector,
    vector,
    with_number,
    with_vector,
)
from scenic.runtime.values.definite import Orientation, OrientedVector, Vector
from scenic.runtime.values.describing import describe, wrong_type
from scenic.runtime.values.methods import Operand
from scenic.runtime.values.nodes import (
    CODEC,
    as_node,
    as_value,
    is_number,
    is_orientation,
    is_vector,
    kind_of,
)
from scenic.runtime.values.random_values import Random, is_random

__all__ = [
    "CODEC",
    "IDENTITY",
    "NOTHING",
    "Orientation",
    "OrientedVector",
    "Random",
    "Vector",
    "apply",
    "as_node",
    "as_value",
    "binary",
    "describe",
    "element_of",
    "elements_of",
    "fixed_batch",
    "folded",
    "holds_instances",
    "is_answered_by_code",
    "is_choice_of_frozen",
    "is_number",
    "is_open",
    "is_orientation",
    "is_random",
    "is_vector",
    "kind_of",
    "operate",
    "options_of",
    "over_options",
    "per_option",
    "random_key",
    "rejection",
    "select",
    "to_heading",
    "to_orientation",
    "to_scalar",
    "to_vector",
    "unary",
    "uniform",
    "vector",
    "wrong_type",
]

Operand._operate = staticmethod(operate)
Operand._vector = staticmethod(vector)
Operand._to_scalar = staticmethod(to_scalar)
Operand._to_vector = staticmethod(to_vector)
Operand._to_orientation = staticmethod(to_orientation)
Operand._as_drawn = staticmethod(as_drawn)
Operand._is_vector = staticmethod(is_vector)
Operand._is_orientation = staticmethod(is_orientation)
Operand._with_vector = staticmethod(with_vector)
Operand._with_number = staticmethod(with_number)
Random._element = staticmethod(element)
Random._attribute = staticmethod(attribute)
Random._called = staticmethod(called)
