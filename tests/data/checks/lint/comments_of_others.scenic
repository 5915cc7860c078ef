x = 3 // note
#        ^^^^ SC202 the name `note` is not defined
ego = new Object left of eg
#                        ^^ SC202 the name `eg` is not defined
new Object facing tow
#                 ^^^ SC202 the name `tow` is not defined
y = positon + limt + pos(3)
#   ^^^^^^^ SC202 the name `positon` is not defined
#             ^^^^ SC202 the name `limt` is not defined
#                    ^^^ SC202 the name `pos` is not defined
