 S(p =
     Range,
 q = Range
 == None == [
 None
    for [] in
     Range for [
] in
   S for x in
 S
   ]
not in S |
S,
  k
  = S
   ): pass
