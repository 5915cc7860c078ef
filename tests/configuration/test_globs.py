import fnmatch

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from scenic.configuration.globs import matches


@pytest.mark.parametrize(
    ("pattern", "path", "expected"),
    [
        ("old", "old", True),
        ("old", "old/a.scenic", True),
        ("old", "new/old/a.scenic", True),
        ("old/", "new/old/a.scenic", True),
        ("/old", "old/a.scenic", True),
        ("/old", "new/old/a.scenic", False),
        ("new/old", "new/old/a.scenic", True),
        ("new/old", "x/new/old/a.scenic", False),
        ("*.sc", "a/b.sc", True),
        ("*.sc", "a/b.scenic", False),
        ("a/*.sc", "a/b.sc", True),
        ("a/*.sc", "a/b/c.sc", False),
        ("a/**", "a/b/c.sc", True),
        ("a/**/c.sc", "a/b/d/c.sc", True),
        ("a/**/c.sc", "a/c.sc", True),
        ("**/c.sc", "c.sc", True),
        ("**/c.sc", "a/xc.sc", False),
        ("a?.sc", "ab.sc", True),
        ("a?.sc", "a.sc", False),
        ("[ab].sc", "b.sc", True),
        ("[!ab].sc", "b.sc", False),
        ("[!ab].sc", "c.sc", True),
        ("[]]x", "]x", True),
        ("[a-c]x", "bx", True),
        ("[a-c]x", "-x", False),
        ("[a-]x", "-x", True),
        ("[!a-c]x", "dx", True),
        ("[&&[~~]x", "&x", True),
        ("[", "[", True),
        ("[z-a]", "[z-a]", True),
        ("a.c", "abc", False),
        ("[^a]", "^", True),
    ],
)
def test_patterns(pattern: str, path: str, expected: bool) -> None:
    assert matches(path.split("/"), pattern) is expected


@given(
    st.text(st.sampled_from("ab*?.[]!"), min_size=1, max_size=8), st.text("ab.[]!", min_size=1, max_size=6)
)
@example("[!]", "[")
def test_single_names_match_as_in_the_standard_library(pattern: str, name: str) -> None:
    assert matches([name], pattern) is fnmatch.fnmatchcase(name, pattern.replace("**", "*"))
