"""The values a program computes with: numbers, vectors and orientations, definite or random.

A random value wraps a node of the value graph. Every function here takes definite and random values alike: with definite
operands an operation is evaluated at once, by the same reading that batches use; with a random one it becomes a node. So
the language's operators, vector methods and specifier formulas are each written once.

Each idea has its module, and stands on those before it: `rows` and `random_base` (what operations know of definite and random
values), `nodes` (values as nodes and back), `choices` (option by option), `applying` (operations), `access` (elements, attributes and
calls of random values), `coercions` (what is taken for what), `methods`, and `definite` and `random_values` (the classes that
programs see). `generic` declares what only modules above can do. Others use values through this module.
"""

from scenic.runtime.values.access import (
    NOTHING,
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
)
from scenic.runtime.values.definite import Orientation, OrientedVector, Vector
from scenic.runtime.values.describing import describe, wrong_type
from scenic.runtime.values.nodes import (
    CODEC,
    as_node,
    as_value,
    is_number,
    is_orientation,
    is_vector,
    kind_of,
)
from scenic.runtime.values.random_base import is_random
from scenic.runtime.values.random_values import Random

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
