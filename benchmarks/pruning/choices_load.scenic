# Loads from a catalogue that fit a lorry.
catalogue = (120, 350, 480, 760, 990)
loads = [Uniform(*catalogue) for i in range(4)]
require 3440 <= loads[0] + loads[1] + loads[2] + loads[3] <= 3460
require loads[0] > loads[1]
param loads = loads
