x = 1
  y = 2
z = 3
class Car:
    width: 2
   length: 4
    height: 1
	speed: 3
def f(a):
    for b in a:
        if b:
            print(b)
      else:
            print(a)
    return a
behavior B():
  wait
    wait
  take 1 2
ego = new Car at 1,
    with width 2,
      with height 3,
    with speed = 4
last = 8
