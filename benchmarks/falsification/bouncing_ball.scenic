from problems import bouncing_ball

param robustness = distributionFunction(bouncing_ball)(
    VerifaiRange(2, 10),
    VerifaiRange(-6, 6),
    VerifaiRange(0.6, 0.98),
    VerifaiRange(0, 3)
)
ego = new Object
