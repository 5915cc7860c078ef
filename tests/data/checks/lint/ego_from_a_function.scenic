def create():
    ego = new Object
create()
new Object ahead of ego
