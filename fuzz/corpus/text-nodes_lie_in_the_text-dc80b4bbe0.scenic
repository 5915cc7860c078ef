class C[* p, * p](** Range,):
    C at ~C intersects() == distance from not B'''=''' b'' to None; raise C from C
scenario S: pass
