"""Falsification problems that exist as formulas: each function gives the robustness of a run, negative where it fails.

Their unsafe sets are small parts of the space, known by exhaustive sampling (`benchmarks/searching.py --share`).
"""

import math


def bouncing_ball(height: float, speed: float, restitution: float, wind: float) -> float:
    """8.6 m less the third apex of a ball that is dropped from a height with a speed, in an updraught."""
    g = 9.81 - wind
    energy = g * height + speed * speed / 2
    for _ in range(3):
        energy *= restitution * restitution
    return 8.6 - energy / g


def mountain_car(start: float, velocity: float, power: float, fault_at: float, fault_length: float) -> float:
    """The greatest height above the flag, in 160 steps, of a car that pushes along its velocity; its engine fails for some."""
    x, v, best = start, velocity, start
    for step in range(160):
        push = 0.0 if fault_at <= step < fault_at + fault_length else power * (1 if v >= 0 else -1)
        v = max(-0.07, min(0.07, v + push - 0.0025 * math.cos(3 * x)))
        x += v
        if x < -1.2:
            x, v = -1.2, 0.0
        best = max(best, x)
    return best - 0.45


def cart_pole(angle: float, rate: float, gain: float, damping: float, delay: float) -> float:
    """By how much a pole on a cart stays within 1 rad in five seconds, under a controller that reacts late."""
    x, dx, a, da, worst = 0.0, 0.0, angle, rate, abs(angle)
    lag = [(a, da)] * (1 + round(delay))
    for _ in range(250):
        lag.append((a, da))
        seen = lag.pop(0)
        force = max(-10.0, min(10.0, gain * seen[0] + damping * seen[1]))
        temporary = (force + 0.05 * da * da * math.sin(a)) / 1.1
        acceleration = (9.8 * math.sin(a) - math.cos(a) * temporary) / (
            0.5 * (4 / 3 - 0.1 * math.cos(a) ** 2 / 1.1)
        )
        dx += 0.02 * (temporary - 0.05 * acceleration * math.cos(a) / 1.1)
        x += 0.02 * dx
        da += 0.02 * acceleration
        a += 0.02 * da
        worst = max(worst, abs(a))
        if worst > 3:
            break
    return 1.0 - worst


def cruise(gap: float, speed: float, lead: float, brake_at: float, brake: float, reaction: float) -> float:
    """The least gap to a leading car that brakes at some moment, less one metre, under a cruise controller."""
    ego_v, lead_v, distance, least, acceleration = speed, lead, gap, gap, 0.0
    for step in range(200):
        if step > brake_at:
            lead_v = max(0.0, lead_v - 0.1 * brake)
        wanted = 0.3 * (distance - 5 - 1.4 * ego_v) + 0.8 * (lead_v - ego_v)
        acceleration += (max(-6.0, min(2.0, wanted)) - acceleration) * 0.1 / reaction
        ego_v = max(0.0, ego_v + 0.1 * acceleration)
        distance += 0.1 * (lead_v - ego_v)
        least = min(least, distance)
    return least - 1


def aircraft(roll: float, rate: float, *stick: float) -> float:
    """By how much the bank angle of an aircraft stays within 75 degrees, the stick held still for a second each time."""
    angle, p, worst = roll, rate, abs(roll)
    for held in stick:
        for _ in range(20):
            p += 0.05 * (-1.8 * p + 2.2 * held - 0.6 * angle)
            angle += 0.05 * p
            worst = max(worst, abs(angle))
    return math.radians(75) - worst
