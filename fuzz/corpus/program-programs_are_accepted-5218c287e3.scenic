x = new Object, 
    with y (lambda: f'{ {1: 2} !r:{x}>}'),
    facing visible[0]
