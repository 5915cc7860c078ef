"""The driving domain: road networks, cars and pedestrians, how they behave and are simulated."""
