"""What is in scope where: names are read where they are bound, and bound once where that is asked."""

import ast
from collections import Counter

from fuzz.draws import RandomDraws
from fuzz.grammar import make_program
from fuzz.names import SCALE, Names, Role
from scenic.compiler.check import check_text
from scenic.compiler.parser import parse


def names(*, wild: bool = False) -> Names:
    return Names(["facing", "wait"], wild=wild)


def read(scopes: Names) -> set[str]:
    """What may be read, but for what is provided and what makes no sense."""
    found = {scopes.choose(Role.READ, number, lambda _: True) for number in range(0, SCALE, 16)}
    return found & {"x", "f", "p", "C", "ego"}


def bind(scopes: Names, role: Role) -> str:
    return scopes.choose(role, 0, lambda _: True)


def test_what_a_line_binds_is_read_after_it():
    scopes = names()
    assert bind(scopes, Role.BIND_VALUE) == "x"
    assert read(scopes) == set()
    scopes.end_line()
    assert read(scopes) == {"x"}


def test_parameters_are_read_in_their_function_only():
    scopes = names()
    bind(scopes, Role.BIND_FUNCTION)
    scopes.open_signature()
    assert bind(scopes, Role.PARAMETER) == "p"
    assert bind(scopes, Role.PARAMETER) != "p"
    scopes.open("def")
    assert read(scopes) >= {"f", "p"}
    bind(scopes, Role.BIND_VALUE)
    scopes.end_line()
    assert read(scopes) == {"f", "p", "x"}
    scopes.close()
    scopes.close_signature()
    assert read(scopes) == {"f"}


def test_names_of_a_class_are_out_of_reach_of_its_methods():
    scopes = names()
    scopes.open("class")
    bind(scopes, Role.BIND_VALUE)
    scopes.end_line()
    assert read(scopes) == {"x"}
    scopes.open("def")
    assert read(scopes) == set()


def test_the_ego_is_there_once_it_is_set():
    scopes = names()
    assert not scopes.has_ego()
    assert bind(scopes, Role.TRACKED) == "ego"
    scopes.end_line()
    assert scopes.has_ego()
    assert read(scopes) == {"ego"}


def test_nonlocal_names_are_those_of_functions_around():
    scopes = names()
    bind(scopes, Role.BIND_VALUE)
    scopes.end_line()
    scopes.open("def")
    assert not scopes.has_outer()
    bind(scopes, Role.BIND_VALUE)
    scopes.end_line()
    scopes.open("def")
    assert scopes.has_outer()
    assert bind(scopes, Role.NONLOCAL) == "x"


def test_a_name_that_does_not_fit_is_not_chosen():
    scopes = names(wild=True)
    for number in range(0, SCALE, 64):
        assert scopes.choose(Role.READ, number, lambda name: name != "facing") != "facing"


def test_programs_seldom_read_what_nothing_binds():
    codes = Counter[str]()
    count = 0
    for seed in range(150):
        program = make_program(RandomDraws(seed))
        if not program.wild:
            count += 1
            codes.update({each.code for each in check_text(program.text, filename="program.scenic")})
    # A few names are read from anywhere, so that undefined ones are met as well.
    assert codes["SC202"] < 0.15 * count
    assert codes["SC200"] + codes["SC209"] < 0.08 * count
    # Statements stand where they may.
    assert codes["SC201"] <= 0.02 * count


def test_programs_use_what_they_bind():
    bound = used = 0
    for seed in range(100):
        tree = parse(make_program(RandomDraws(seed)).text).tree
        found = [node for node in ast.walk(tree) if isinstance(node, ast.Name)]
        stored = {node.id for node in found if isinstance(node.ctx, ast.Store)}
        bound += len(stored)
        used += len(stored & {node.id for node in found if isinstance(node.ctx, ast.Load)})
    assert used > bound / 4
