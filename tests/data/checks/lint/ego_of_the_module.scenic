ego = new Object
scenario Main():
    new Object ahead of ego
    ego = new Object
