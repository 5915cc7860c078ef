take 3
#^^^^^ SC201 `take` cannot be used at the top level
wait
#^^^ SC201
do f()
#^^^^^ SC201
terminate
#^^^^^^^^ SC201
return 3
#^^^^^^^ SC201 `return` cannot be used at the top level
yield 3
#^^^^^^ SC201
break
#^^^^ SC201 `break` outside of a loop
for i in range(3):
    continue
else:
    break
    #^^^^ SC201
def f():
    while True:
        def g(): break
        #        ^^^^^ SC201
        break
    yield 3
    from os import *
    #^^^^^^^^^^^^^^^ SC201 `import *` can only be used at the top level
    model a.b
    #^^^^^^^^ SC201
class C:
    require True
    #^^^^^^^^^^^ SC201 `require` cannot be used in the body of a class
    ego = 3
    #^^^^^^ SC201
    param a = 3
    #^^^^^^^^^^ SC201
    width: 3
    if True:
        require True
        #^^^^^^^^^^^ SC201
    def method(self):
        require self.x > 3
        return 3
    behavior Inner():
    #^^^^^^^^^^^^^^^^ SC201
        wait
behavior B():
    take 1, 2
    abort
    #^^^^ SC201 `abort` outside of a try-interrupt statement
    try:
        abort
    interrupt when f():
        abort
    except ValueError:
        abort
        #^^^^ SC201
    def helper():
        wait
        #^^^ SC201 `wait` cannot be used in a function in a behavior
    yield 3
    #^^^^^^ SC201 `yield` cannot be used in a behavior
    return
    async def h(): pass
    #^^^^^^^^^^^^^^^^^^ SC201
    param x = 3
    #^^^^^^^^^^ SC201
    behavior Nested():
    #^^^^^^^^^^^^^^^^^ SC201
        wait
scenario S():
    setup:
        param b = 3
        take 3
        #^^^^^ SC201 `take` cannot be used in the setup of a scenario
        model a.b
        #^^^^^^^^ SC201
        return
await f()
#^^^^^^^^ SC201 `await` outside of an `async def` function
async def coroutine():
    await f()
    async for i in f(): break
