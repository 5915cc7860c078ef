"""Weights of the choices that the grammar leaves: the only table of such numbers.

Every alternative that is not named here has the weight 1, so that the shares follow from how many there are: a rule that
only refers to others counts as the square root of what these have. A key is an alternative, called as in
``fuzz/narrowing.gram`` (``rule__key``), or a rule, for all of its own alternatives. Above all, programs should use Scenic's
statements about as often as Python's, and should have short expressions.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

__all__ = ["WEIGHTS"]

WEIGHTS: Final[Mapping[str, float]] = MappingProxyType(
    {
        # Expressions: mostly names.
        "atom__Name": 10,
        "atom__number": 3,
        "atom__initial_scenario": 0.3,
        "new_expression": 3,
        # Statements.
        "statement__simple_statements": 2,
        "simple_statement__soft_statement": 2,
        "tracked_assignment": 3,
        "tracked_block_assignment": 4,
        "compound_statement__behavior_definition": 4,
        "compound_statement__monitor_definition": 2,
        "compound_statement__scenario_definition": 4,
        "compound_statement__match_statement": 0.5,
        "keyword_statement__require_statement": 3,
        "keyword_statement__do_statement": 3,
        "keyword_statement__deletable": 0.5,
        "done": 2,
        "temporal_not__temporal_group": 8,
        "temporal_implies__Temporal": 3,
        "temporal_expression__1": 4,
        # What newer versions of Python have is refused by older ones, and nothing more can be seen of the program.
        "soft_statement__type_alias": 0.2,
    }
)
