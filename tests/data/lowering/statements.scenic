model vehicles.cars
param time = 12, "weather conditions" = Uniform("rain", "sun")
simulator make_simulator(globalParameters.time)
behavior Drive(speed=1 deg, *, target=None):
    """Drive on."""
    precondition: self.speed > 1
    while True:
        take SetSpeed(speed)
        do Turn() for 3 seconds
behavior Wait():
    wait
car = new Car with behavior Drive(3)
require sin(car.speed) > 0 and car in road
