pass
pass
scenario S:
    ''
    setup: pass
    compose: [x] = new Object,
 right of S
