"""Programs whose discrete values are coupled: seconds of loading, candidates a scene, milliseconds a scene.

Run as ``python -m benchmarks.discrete``.
"""

import time

import scenic
from scenic.runtime.sampling.rejection_report import Exhausted

PROGRAMS: dict[str, str] = {
    "slots (16)": """
slots = [(i * 4, 0) for i in range(16)]
ego = new Object at Uniform(*slots), with width 2, with length 4
for i in range(15):
    new Object at Uniform(*slots), with width Uniform(1,2), with length 4
""",
    "different integers (12 of 20)": """
ego = new Object
xs = [DiscreteRange(1, 20) for i in range(12)]
for i in range(12):
    for j in range(i):
        require xs[i] != xs[j]
param xs = xs
""",
    "digits with a sum": """
ego = new Object
d = [DiscreteRange(0, 9) for i in range(10)]
require sum(d) == 45
for i in range(9):
    require (d[i] + d[i+1]) % 2 == 1
param d = d
""",
    "switches": """
ego = new Object
s = [Discrete({True: 1, False: 2}) for i in range(16)]
for i in range(15):
    require (not s[i]) or s[i+1]
param s = s
""",
    "ring in three colours": """
ego = new Object
c = [Uniform('red', 'green', 'blue') for i in range(12)]
for i in range(12):
    require c[i] != c[(i+1) % 12]
param c = c
""",
    "slots with jitter": """
slots = [i * 6 for i in range(10)]
ego = new Object at (Uniform(*slots) + Range(-0.2, 0.2), Range(-.1,.1)), with width 2, with length 4, facing Range(-5, 5) deg
for i in range(9):
    new Object at (Uniform(*slots) + Range(-0.2,0.2), Range(-.1,.1)), with width 2, with length 4, with yaw Range(-5,5) deg
""",
    "magic square": """
ego = new Object
x = [DiscreteRange(1, 9) for i in range(9)]
for i in range(9):
    for j in range(i):
        require x[i] != x[j]
for i in range(3):
    require x[3*i] + x[3*i+1] + x[3*i+2] == 15
    require x[i] + x[3+i] + x[6+i] == 15
require x[0]+x[4]+x[8] == 15
require x[2]+x[4]+x[6] == 15
param x = x
""",
    "Latin square": """
ego = new Object
x = [[DiscreteRange(1, 4) for j in range(4)] for i in range(4)]
for i in range(4):
    for j in range(4):
        for k in range(j):
            require x[i][j] != x[i][k]
            require x[j][i] != x[k][i]
param x = x
""",
    "clues": """
ego = new Object
c = [Uniform('r','g','b','y','w','k') for i in range(5)]
def score(code, guess):
    return sum(1 for a, b in zip(code, guess) if a == b)
require score(c, ['r','g','b','y','w']) == 2
require score(c, ['r','r','g','g','k']) == 1
require score(c, ['k','k','w','w','b']) == 1
param c = c
""",
    "parking with sizes": """
slots=[(i*3, 2.4+0.3*(i%4)) for i in range(10)]
ego = new Object at (-20,0)
s=[Uniform(*range(10)) for i in range(8)]
w=[Uniform(1.8, 2.3, 2.6) for i in range(8)]
for i in range(8):
    require w[i] + 0.3 < 2.4 + 0.3*(s[i] % 4)
    for j in range(i):
        require s[i] != s[j]
param v=s
""",
    "seating with preferences": """
ego = new Object
s=[DiscreteRange(0,7) for i in range(8)]
for i in range(8):
    for j in range(i):
        require s[i] != s[j]
require abs(s[0]-s[1]) == 1
require abs(s[2]-s[3]) > 2
require s[4] < s[5]
param v=s
""",
    "timetable": """
ego = new Object
t=[DiscreteRange(0,5) for i in range(10)]
room=[Uniform('a','b') for i in range(10)]
for i in range(10):
    for j in range(i):
        require t[i] != t[j] or room[i] != room[j]
for i in range(0,10,2):
    require t[i] < t[i+1]
param v=t
""",
    "colouring of a graph": """
ego = new Object
E=[(0,1),(1,2),(2,3),(3,4),(4,0),(0,5),(1,6),(2,7),(3,8),(4,9),(5,7),(7,9),(9,6),(6,8),(8,5)]
c=[Uniform('r','g','b') for i in range(10)]
for a,b in E:
    require c[a] != c[b]
param v=c
""",
    "different integers (26 of 30)": """
ego = new Object
xs = [DiscreteRange(1, 30) for i in range(26)]
require len(set(xs)) == 26
param v=xs
""",
    "dominoes": """
ego = new Object
tiles=[(a,b) for a in range(7) for b in range(a,7)]
d=[Uniform(*tiles) for i in range(6)]
for i in range(5):
    require d[i][1] == d[i+1][0]
param v=d
""",
    "one of many": """
ego = new Object
s=[Discrete({1:1,0:2}) for i in range(20)]
require sum(s) == 1
param v=s
""",
    "forbidden places": """
ego = new Object
s=[DiscreteRange(0,11) for i in range(12)]
for i in range(12):
    require s[i] != i
    for j in range(i):
        require s[i] != s[j]
param v=s
""",
}
SCENES = 200
MOST = 3000


def main() -> None:
    """Print a line for each program."""
    scenic.scenarioFromString("ego = new Object at (Range(0, 1), 0)").sample(1, seed=0)
    for name, text in PROGRAMS.items():
        start_time = time.process_time()
        scenario = scenic.scenarioFromString(text)
        loaded = time.process_time()
        results = list(scenario.stream(SCENES, seed=1, max_attempts=MOST))
        seconds_spent = 1000 * (time.process_time() - loaded) / SCENES
        scene_count = sum(not isinstance(result, Exhausted) for result in results)
        attempts = sum(result.attempts for result in results) / SCENES
        print(
            f"{name:32} {loaded - start_time:6.2f} s {attempts:8.2f} candidates {seconds_spent:8.3f} ms {scene_count:4} found",
            flush=True,
        )


if __name__ == "__main__":
    main()
