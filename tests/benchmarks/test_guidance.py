"""Messages about the mistakes of `benchmarks.guidance` are at the right place, say the cause, and repair nothing wrongly."""

import pytest

from benchmarks.guidance import judge, read


@pytest.mark.parametrize("name", ["first", "second", "third", "fourth", "fifth", "sixth"])
def test_messages_lead_to_the_repair(name: str) -> None:
    judgements = list(judge(list(read(name))))
    count = len(judgements)
    assert sum(each.place for each in judgements) >= 0.95 * count
    assert sum(each.cause for each in judgements) >= 0.9 * count
    assert [each.mistake.number for each in judgements if each.repair in ("other", "wrong")] == []
    assert [each.mistake.number for each in judgements if each.accused] == []
