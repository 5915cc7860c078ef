A = Range(0, 1)
B = Range(0, 2)
C = Uniform(1, 2, 3)
count = 4

def lambda_free(first, rest, key=None):
    result = first < 10
    for each in rest:
        result = result and each < 10
    if key is None:
        return result
    return result and key < 10

ego = new Object at (A, B, 0), with name "ego"
other = new Object at (5, B, 0), with name "other"
region = BoxRegion(dimensions=(10, 10, 10))

require A < B
require A + B < 2.5 and C != 2
require not (A > 0.9 or B > 1.9)
require A if C == 1 else B
require always (A < 1)
require eventually (B > 0.5 and C > 1)
require (always A < 2) and (eventually B > 0)
require (A < 3) until (B > 1)
require A < 2 implies (next B < 2)
require always (A < 1 implies eventually B < 1)
require[0.25] C > 1 as "rarely"
require ego in region as inside
require (distance from ego to other) > 3 as 7
require ego.position.x - other.position.x < 0
require max(A, B, C) <= 3
require lambda_free(A, [B, C], key=C)

require C in (1, 2, 3)
require {1: A, 2: B}[2] < 3
require [A, B, C][count % 3] < 4
require -1 <= A <= 1
require A ** 2 + B ** 2 < 5
require (ego.width * ego.length) < 2 and \
    (other.width * other.length) < 2
require any(
    value > 0.5
    for value in (A, B)
)
terminate when A > 2 as done
terminate simulation when B > 4
terminate after 30 steps
record A as first
record B every 3 steps after 2 steps as second
record initial C as third
record final A + B as total
mutate
mutate ego by 2
mutate ego, other
param a = A, b = B
param 'c' = C
