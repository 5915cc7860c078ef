"""Parts of batches: what they declare fits the commands, and one place refuses options."""

from collections import Counter
from collections.abc import Sequence

import click
import pytest

from scenic.cli import check, estimate, falsify, sample_parts, simulate_options
from scenic.cli.batch_parts import BatchPart, SinkPart, check_parts, forms_help, output_help
from scenic.cli.check import check as check_command
from scenic.cli.estimate import estimate as estimate_command
from scenic.cli.falsify import falsify as falsify_command
from scenic.cli.sample import sample
from scenic.cli.sample_parts import SINKS
from scenic.cli.simulate import simulate

COMMANDS = [
    (
        sample,
        [*SINKS.values(), *(part for part in vars(sample_parts).values() if isinstance(part, BatchPart))],
    ),
    (simulate, [simulate_options.FOLDER]),
    (falsify_command, [part for part in vars(falsify).values() if isinstance(part, BatchPart)]),
    (estimate_command, [part for part in vars(estimate).values() if isinstance(part, BatchPart)]),
    (check_command, [part for part in vars(check).values() if isinstance(part, BatchPart)]),
]


@pytest.mark.parametrize(("command", "parts"), COMMANDS, ids=[command.name for command, _ in COMMANDS])
def test_parts_name_options_that_the_command_has(command: click.Command, parts: Sequence[BatchPart]) -> None:
    assert parts
    options = {item.name for item in command.params}
    for part in parts:
        assert part.adds | part.refuses <= options, part.name
        assert not part.adds & part.refuses, part.name


def test_endings_and_formats_choose_one_sink() -> None:
    endings = Counter(ending for sink in SINKS.values() if sink.help for ending in sink.endings)
    forms = Counter(form for sink in SINKS.values() for form in sink.forms)
    assert set(endings.values()) == set(forms.values()) == {1}
    texts = {item.name: getattr(item, "help", None) or "" for item in sample.params}
    assert all(ending in texts["output"] for ending in endings)
    assert all(form in texts["form"] for form in forms)
    (form_option,) = (item for item in sample.params if item.name == "form")
    assert isinstance(form_option.type, click.Choice)
    assert list(form_option.type.choices) == list(forms)


LINES = SinkPart("lines", frozenset({"width"}), frozenset({"fast"}), "lines", (".txt", ""))
TABLE = SinkPart("a table", help="columns", endings=(".csv",), forms=("wide", "long"), extra="tables")
SLOW = BatchPart("--slow", refuses=frozenset({"fast", "slow"}))


@click.command()
@click.option("--width", type=int, default=3)
@click.option("-f", "--fast", is_flag=True)
@click.option("--slow", is_flag=True)
@click.option("--table", is_flag=True)
def command(width: int, fast: bool, slow: bool, table: bool) -> None:
    check_parts([TABLE if table else LINES, *([SLOW] if slow else [])], [LINES, TABLE])


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--width 4", None),
        ("--table --width 4", "--width is for lines"),
        ("--table --width 3", None),  # the default, which every sink understands
        ("--fast", "-f does not go with lines; it goes with a table"),
        ("--table --fast", None),
        ("--table --fast --slow", "-f does not go with --slow"),
        ("--slow", None),
    ],
)
def test_an_option_that_a_part_does_not_understand_is_refused(line: str, message: str | None) -> None:
    if message is None:
        command.main(line.split(), standalone_mode=False)
        return
    with pytest.raises(click.UsageError) as refusal:
        command.main(line.split(), standalone_mode=False)
    assert refusal.value.message == message


def test_help_is_made_of_the_declarations() -> None:
    assert output_help([LINES, TABLE]) == "lines (.txt, none); columns (.csv, extra `tables`)."
    assert forms_help([LINES, TABLE]) == "wide, long for a table.  [default: the first]"
