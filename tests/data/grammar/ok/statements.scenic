model a.b.c
param a = 1, 'b c' = 2, """d""" = (yield_ + 3)
simulator S(1)
mutate
mutate a, b
mutate a by 2
mutate by 3
ego = new Object
workspace = Workspace(r)
require x > 3
require x as foo
require[0.5] x as "a b"
require [x]
require monitor M() as 7
require always x until (eventually y) implies z
record x
record initial x as a
record final x
record x every 3 seconds after 2 steps as a
record x every n seconds to "file"
record final
terminate when x as a
terminate simulation when x
terminate after 3 seconds
terminate after (n + 1) steps
x = 1; require x; param y = 2; pass
if x: mutate; require y
