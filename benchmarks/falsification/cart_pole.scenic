from problems import cart_pole

param robustness = distributionFunction(cart_pole)(
    VerifaiRange(-0.15, 0.15),
    VerifaiRange(-0.3, 0.3),
    VerifaiRange(20, 60),
    VerifaiRange(4, 16),
    VerifaiRange(0, 4)
)
ego = new Object
