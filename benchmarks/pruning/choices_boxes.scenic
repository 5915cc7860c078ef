# Sizes of boxes on a shelf of 1.225 m, filled within 1.5 cm.
sizes = (0.17, 0.23, 0.31, 0.38)
widths = [Uniform(*sizes) for i in range(4)]
require 1.21 < widths[0] + widths[1] + widths[2] + widths[3] < 1.225
require widths[0] > widths[1] and widths[2] > widths[3]
param widths = widths
