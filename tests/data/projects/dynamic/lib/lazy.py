def __getattr__(name):
    return 1


known = 2
