async def f(): yield from None
