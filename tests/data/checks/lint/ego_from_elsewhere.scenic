import room
new Object ahead of ego
