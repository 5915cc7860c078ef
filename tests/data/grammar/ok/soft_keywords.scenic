wait
wait()
wait = 3
take(3)
take
take = wait
take.x = 3
take[1]
record(x)
record
record[1] = 2
record.y
simulator(x)
simulator = x
param
param = 3
param.x
model
model = 1
mutate = 3
mutate.x
terminate = 3
abort
abort()
override = 3
override.x
ego.tag = 1
choose = 1
do choose
do choose()
monitor = monitor
behavior = 3
scenario.x = behavior.y
require monitor
require next(x)
next(x)
always = eventually
visible = 3
visible(r)
visible[1] = 2
visible.f = 3
f(visible, visible * a)
left = right = top = bottom
front.x = back(1)
distance = angle + altitude
distance.x(position, heading)
initial = final
initial + scenario
match = case
match(x)
match[1] = 3
type = 3
type(x)
precondition: x
invariant = 3
setup = compose
seconds = steps
deg = can = see = 3
for interrupt in when: offset
_ = minimum
