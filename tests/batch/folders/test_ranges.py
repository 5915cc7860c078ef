"""Parts by range: names that never coincide, and gaps that are filled exactly."""

from hypothesis import given
from hypothesis import strategies as st

from scenic.batch.folders.ranges import gaps, part_name, ranges_to_make

BOUNDS = st.lists(st.integers(0, 60), unique=True, max_size=12).map(sorted)


@given(st.integers(0, 40), st.integers(0, 40), st.integers(1, 9), BOUNDS)
def test_what_is_made_and_what_is_there_is_the_whole(
    first: int, count: int, size: int, bounds: list[int]
) -> None:
    parts = list(zip(bounds[::2], bounds[1::2], strict=False))
    made = ranges_to_make((first, first + count), size, parts)
    numbers = [k for start, stop in made for k in range(start, stop)]
    there = {k for start, stop in parts for k in range(start, stop)}
    assert numbers == [k for k in range(first, first + count) if k not in there]
    assert all((start - first) // size == (stop - 1 - first) // size for start, stop in made)
    assert sum(stop - start for start, stop in gaps((first, first + count), parts)) == len(numbers)


@given(st.lists(st.tuples(st.integers(0, 10**9), st.integers(1, 10**6)), min_size=2, max_size=8, unique=True))
def test_names_differ_as_ranges_do_and_sort_by_first_scene(ranges: list[tuple[int, int]]) -> None:
    names = [part_name((first, first + count)) for first, count in ranges]
    assert len(set(names)) == len(ranges)
    small = [item for item in ranges if sum(item) < 10**8]
    assert sorted(small) == sorted(small, key=lambda item: part_name((item[0], sum(item))))
