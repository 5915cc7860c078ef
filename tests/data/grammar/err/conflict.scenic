class Car:
    width: 2
<<<<<<< HEAD
    length: 4
=======
    length: 5
    height: 6
>>>>>>> branch
    speed: 3 3
cars = [
    1,
<<<<<<< HEAD
    2,
=======
    3,
>>>>>>> branch
]
last = 8
