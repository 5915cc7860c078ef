do shufflecomment  ] 
@ False
async def f[y, ** M#(*, self):
	abort
