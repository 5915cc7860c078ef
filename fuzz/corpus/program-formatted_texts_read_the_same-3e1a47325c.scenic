class C:
    terminate; x: C
