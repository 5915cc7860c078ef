"""Known mistakes: one small rule each, which suggests the intended text.

A rule looks at a `Situation` and gives a problem, or ``None`` if it is not its mistake. The first of `RULES` that gives
one is believed, so they go from the unmistakable to the merely likely.
"""

from collections.abc import Callable
from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.mistakes import (
    blocks,
    dialects,
    elsewhere,
    instances,
    operators,
    python,
    statements,
    words,
)
from scenic.compiler.mistakes.blocks import header_without_colon, unfinished_header
from scenic.compiler.mistakes.situation import Situation
from scenic.compiler.mistakes.trial import Trials

__all__ = [
    "RULES",
    "Situation",
    "Trials",
    "explain",
    "header_without_colon",
    "instead_of_failure",
    "unfinished_header",
]

Rule = Callable[[Situation], SyntaxProblem | None]

RULES: Final[tuple[Rule, ...]] = (
    # Forms that nothing else looks like.
    python.replacement_field,
    elsewhere.comment,
    elsewhere.block_comment,
    elsewhere.else_if,
    elsewhere.unit,
    dialects.braces,
    dialects.continuation,
    dialects.duration_of_action,
    dialects.bound_of_condition,
    dialects.number_between,
    blocks.clause_without_beginning,
    statements.parts_of_scenario,
    statements.definition_without_name,
    blocks.try_alone,
    blocks.decorator_alone,
    blocks.missing_block,
    blocks.unexpected_indent,
    python.two_commas,
    statements.monitor_without_parentheses,
    statements.definition_without_parentheses,
    statements.constructor,
    statements.attribute_of_property,
    python.print_statement,
    python.except_of_several,
    python.raise_of_two,
    elsewhere.import_from,
    elsewhere.declaration,
    instances.missing_class,
    instances.dotted_class,
    instances.call_of_class,
    instances.new_as_operand,
    operators.after_degrees,
    statements.probability,
    statements.message_of_requirement,
    statements.setting_of_parameter,
    statements.quoted_module,
    words.negated_sight,
    words.other_word,
    statements.initial_or_final_clause,
    instances.missing_comma_between_lines,
    statements.stray_specifier,
    # Those that a trial confirms.
    instances.comma_after_class,
    python.trailing_comma,
    instances.another_place,
    dialects.side_of_object,
    words.misspelt,
    dialects.setting_of_property,
    statements.target_first,
    words.order_of_corners,
    operators.loose_prefix_operator,
    statements.annotated_property,
    elsewhere.operator,
    elsewhere.increment,
    elsewhere.first_word,
    python.misplaced_walrus,
    python.keyword_assigned,
    instances.missing_new,
    instances.equals_in_specifier,
    instances.unbracketed_coordinates,
    python.missing_loop_word,
    python.missing_comma_of_import,
    python.bare_generator,
    python.call_without_parentheses,
    statements.clauses_out_of_order,
    words.between,
    words.kind_of_heading,
    words.operator_without_left_side,
    words.missing_word,
    words.missing_operand,
    words.wrong_word,
    words.needless_word,
    instances.missing_comma_between_specifiers,
    instances.foreign_clause,
    operators.chained_temporal,
    operators.temporal_elsewhere,
    operators.temporal_after_operand,
    operators.temporal_operand,
    blocks.missing_colon,
    python.assignment_in_condition,
    python.missing_comma,
    # Those that are only likely.
    words.perhaps_misspelt,
    python.conditional_without_else,
    python.missing_dictionary_value,
    statements.missing_unit,
    statements.not_a_plain_name,
    python.keyword_as_name,
    operators.loose_operand,
    statements.statement_in_expression,
)


def instead_of_failure(at: Situation) -> SyntaxProblem | None:
    """Return the message of a rule that explains better than the parser why a statement is not an assignment; ``None`` if none does."""
    return dialects.setting_of_property(at)


def explain(at: Situation) -> SyntaxProblem | None:
    """Return the message of the first rule that explains the mistake, ``None`` if none does."""
    for rule in RULES:
        problem = rule(at)
        if problem is not None:
            return problem
    return None
