# Speeds of a platoon that agree within 5%.
speeds = [Range(10, 40) for i in range(4)]
for one, other in zip(speeds, speeds[1:]):
    require abs(one - other) < 0.05 * one
param speeds = speeds
