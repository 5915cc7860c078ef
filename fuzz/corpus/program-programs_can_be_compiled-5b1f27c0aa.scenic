@ ()
async def f(): terminate when f << await f
