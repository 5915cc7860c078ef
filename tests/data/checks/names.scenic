import os as path
x = Rnage(1, 2)
#   ^^^^^ SC202 the name `Rnage` is not defined
new Object at undefinedName
#             ^^^^^^^^^^^^^ SC202
def f(a, b=later, *args):
    global counter
    counter = a + args + hidden
    #                    ^^^^^^ SC202
    return path
later = 3
[i for i in later if i]
print(index)
#     ^^^^^ SC202
class C:
    inner = 3
    width: inner
    #      ^^^^^ SC202
    height: self.width + later
    def m(self):
        return inner
        #      ^^^^^ SC202
    copy = inner
def g():
    nonlocalish = 1
    def h():
        nonlocal nonlocalish
        nonlocalish = 2
        return lambda y: y + nonlocalish + z
        #                                  ^ SC202
    return h
try:
    unicode
except NameError:
    unicode = str
behavior B(speed):
    precondition: self.x > speed
    try:
        take selff
        #    ^^^^^ SC202 the name `selff` is not defined
    interrupt when missing:
        #          ^^^^^^^ SC202
        abort
scenario S(a):
    setup:
        b = a
        def inside(): return b + local
        local = 3
        require b + a + c
        #               ^ SC202
match x:
    case [first, *rest]:
        first, rest
    case {"k": value, **others} if value:
        others
try: pass
except* ValueError as group: group
print(__name__, __file__, group, (walrus := 3), walrus)
