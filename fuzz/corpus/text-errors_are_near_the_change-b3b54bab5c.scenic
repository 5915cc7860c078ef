pass
@ None
@ ()
@ Range
class C:
 pass; pass
    pass
