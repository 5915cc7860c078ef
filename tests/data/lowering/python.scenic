"""Python passes through unchanged."""
from __future__ import annotations
import os
x: int = 3
def f(a, /, b: int = 2, *args, c, d=4, **kwargs) -> None:
    global x
    x += a
    yield [i for i in b] if a else None
async def g():
    async with a as b:
        await b
    return {**{}, 1: 2}
a, *b = (lambda: 1), 2
a = b = f"{x!r:>{a}} {ego.width:.2f}"
while x: break
else: pass
try:
    raise ValueError from None
except (OSError, ValueError) as error:
    del x
finally:
    assert x, "no"
print(*b, **{}, sep=a[1:2, ::3])
s = {1, 2} | {n for n in b} ; t = not x is a or -x ** 2 @ 3
