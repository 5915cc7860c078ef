from problems import cruise

param robustness = distributionFunction(cruise)(
    VerifaiRange(35, 70),
    VerifaiRange(15, 30),
    VerifaiRange(20, 35),
    VerifaiRange(0, 150),
    VerifaiRange(1, 7),
    VerifaiRange(0.3, 1.2)
)
ego = new Object
