requirerequire 
Range for Range(
     )
[
    Range] in Range for x in Range)
