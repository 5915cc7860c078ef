"""An arm with seven random joints over a table, and twenty things thrown around it."""

model scenic.simulators.mujoco.model

table = new Fixture at (0, 0, 0.35), with width 1.6, with length 1.2, with height 0.7
ego = new Articulated at (0, -0.4), on table, with description "seven.xml",
    with joints {f'j{i}': Range(-100, 100) deg for i in range(7)}

shapes = (CylinderShape((0.07, 0.07, 0.12)), BoxShape((0.05, 0.08, 0.04)), ConeShape((0.06, 0.06, 0.08)))
for i in range(20):
    new Body resting on table, with shape Uniform(*shapes)
