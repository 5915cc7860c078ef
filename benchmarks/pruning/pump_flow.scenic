# Flow and pressure on the curve of a pump, at the wanted power.
q, p = Range(0, 10), Range(0, 10)
require abs(p + q * q / 12 - 8) < 0.05
require 22 < p * q < 23
param q = q, p = p
