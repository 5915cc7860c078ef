from problems import mountain_car

param robustness = distributionFunction(mountain_car)(
    VerifaiRange(-0.7, -0.4),
    VerifaiRange(-0.02, 0.02),
    VerifaiRange(0.0012, 0.003),
    VerifaiRange(0, 120),
    VerifaiRange(0, 40)
)
ego = new Object
