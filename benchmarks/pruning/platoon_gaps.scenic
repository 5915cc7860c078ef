# Four trucks one after the other with gaps between 5 and 10 metres.
ys = [Range(0, 200) for i in range(4)]
trucks = [new Object at (0, y), with width 2.5, with length 12 for y in ys]
for front, back in zip(trucks, trucks[1:]):
    require 17 < front.y - back.y < 22
