monitor Watch():
#       ^^^^^ SC312 nothing requires the monitor `Watch`
    wait
monitor Guard():
    wait
ego = new Object
require monitor Guard()
