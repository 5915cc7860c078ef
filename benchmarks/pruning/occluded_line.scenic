# Three things nearly on a line with the viewer.
a = new Object at (Range(-20, 20), Range(5, 40))
b = new Object at (Range(-20, 20), Range(5, 40))
ego = new Object at (0, 0)
require abs(a.x * b.y - a.y * b.x) < 4
require b.y > a.y + 10
require a.x > 10
