room = RectangularRegion((0, 0), 0, 4, 4)
ego = new Object in room
x = ego.positon
#       ^^^^^^^ SC214 an object has no attribute `positon`
y = room.diference(room)
#        ^^^^^^^^^ SC214 a region has no attribute `diference`
param speed = 3
z = globalParameters.sped
#                    ^^^^ SC214 this program sets no parameter `sped`
