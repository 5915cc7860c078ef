model world_that_is_not_there
#     ^^^^^^^^^^^^^^^^^^^^^^^ SC406 there is no world model `world_that_is_not_there`
ego = new Car
