class Vehicle:
    wheels: 4

helper = 3
