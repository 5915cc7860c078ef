scenario Only():
    """The only scenario."""
    precondition: ego.width > 3
    setup:
        new Object at (3, 4)
        require (distance to (1, 2)) > 3
        #        ^^^^^^^^^^^^^^^^^^ SC209 `distance` refers to the ego, which is not set yet
        ego = new Object
    compose:
        print(ego)
        wait
