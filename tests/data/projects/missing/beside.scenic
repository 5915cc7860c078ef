class Beside:
    width: 3
