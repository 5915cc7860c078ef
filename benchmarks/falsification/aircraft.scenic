from problems import aircraft

param robustness = distributionFunction(aircraft)(
    VerifaiRange(-0.5, 0.5),
    VerifaiRange(-0.5, 0.5),
    VerifaiRange(-0.55, 0.55),
    VerifaiRange(-0.55, 0.55),
    VerifaiRange(-0.55, 0.55),
    VerifaiRange(-0.55, 0.55),
    VerifaiRange(-0.55, 0.55),
    VerifaiRange(-0.55, 0.55)
)
ego = new Object
