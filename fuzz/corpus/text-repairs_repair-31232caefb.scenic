scenario S:
    ''
    setup:
        assert S | S
    compose:
        pass
        pass
        S not visible from S;
        class C: raise () from C;
        with C or C: pass
        new C facing away from None, right of C, with height C, with behavior C,
            with color𝐱 C
