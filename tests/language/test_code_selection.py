import pytest

from scenic.language.code_selection import Rules, is_lasting, is_selector, longest_match, similar_selector
from scenic.language.diagnostics import CODES, Diagnostic, Severity


def warning(code: str) -> Diagnostic:
    return Diagnostic(code, "m", severity=Severity.WARNING)


@pytest.mark.parametrize(
    ("select", "ignore", "never", "shown"),
    [
        (("SC",), (), (), True),
        (("SC3",), (), (), True),
        (("SC7",), (), (), False),
        (("SC",), ("SC3",), (), False),
        (("SC300",), ("SC3",), (), True),
        (("SC3",), ("SC300",), (), False),
        (("SC300",), ("SC300",), (), False),
        (("SC300",), (), ("SC",), False),
        ((), (), (), False),
    ],
)
def test_the_longer_selector_decides(
    select: tuple[str, ...], ignore: tuple[str, ...], never: tuple[str, ...], shown: bool
) -> None:
    rules = Rules(select, ignore, never)
    assert rules.shows("SC300") is shown
    assert bool(rules.apply([warning("SC300")])) is shown


def test_severities() -> None:
    rules = Rules(severity=(("SC3", Severity.INFORMATION), ("SC300", Severity.ERROR)))
    assert [
        each.severity for each in rules.apply([warning("SC300"), warning("SC390"), warning("SC701")])
    ] == [
        Severity.ERROR,
        Severity.INFORMATION,
        Severity.WARNING,
    ]


@pytest.mark.parametrize("code", ["SC103", "SC606", "SC999"])
def test_some_errors_last(code: str) -> None:
    error = Diagnostic(code, "m")
    assert is_lasting(error)
    assert not is_lasting(warning(code))
    assert Rules((), ("SC",), ("SC",), (("SC", Severity.INFORMATION),)).apply([error]) == (error,)
    assert not is_lasting(Diagnostic("SC202", "m"))


def test_overriding() -> None:
    rules = Rules(("SC3",), ("SC300",), severity=(("SC3", Severity.ERROR),))
    assert rules.overridden((), ("SC7",)).ignore == ("SC300", "SC7")
    chosen = rules.overridden(("SC300",), ())
    assert chosen.shows("SC300")
    assert not chosen.shows("SC390")
    assert chosen.severity == rules.severity


def test_selectors() -> None:
    assert all(map(is_selector, CODES))
    assert all(is_selector(each) for each in ("SC", "SC3", "SC30"))
    assert not any(is_selector(each) for each in ("", "S", "SC8", "sc300", "SC3000", "300"))
    assert similar_selector("sc300") == "SC300"
    assert similar_selector("300") == "SC300"
    assert similar_selector("SC30O") == "SC300"
    assert similar_selector("banana") is None
    assert longest_match("SC300", ["SC", "SC30", "SC301"]) == 4
    assert longest_match("SC300", []) == -1
