import functools

def combine(first, second, /, *rest, scale=1.0, **options):
    total = first + second
    for each in rest:
        total += each * scale
    return total, options

def compose(*functions):
    def composed(value):
        for function in functions:
            value = function(value)
        return value
    return composed

matrix = [
    [1, 2, 3],
    [4, 5, 6],
    [7, 8, 9],
]
settings = dict(
    width=Range(1, 2),
    length=Range(3, 4),
    names=[
        "first",
        "second",
    ],
    nested={
        "deep": (1, 2),
        "deeper": [
            (3, 4),
            (5, 6),
        ],
    },
)
total, options = combine(
    1,
    2,
    *[3, 4],
    scale=2.0,
    **{"unit": "m"},
)
double = lambda value: value * 2
pipeline = compose(double, abs, functools.partial(pow, 2))
result = pipeline(
    matrix[0][1] + matrix[1][2]
)
transposed = [[row[i] for row in matrix] for i in range(3)]
flattened = [value for row in matrix for value in row if value % 2]
corner = matrix[-1][::2]

ego = new Object at (
    Range(-5, 5),
    Range(-5, 5),
    0,
)
wall = new Object at (0, 10, 0), with shape BoxShape(
    dimensions=(1, 2, 3),
    scale=0.5,
)
pieces = [new Object at (x * 3, 20, 0) for x in range(3)]
print(
    total, options, result,
    transposed,
    sep="\n",
)
if (
    total > 3
    and result < 100
):
    print("small")
else:
    print("large")
for index, piece in enumerate(
    pieces,
    start=1,
):
    piece.tag = f"piece {index}"
require (
    ego.position.x > -4
    and ego.position.y > -4
)
require wall.width < 3
