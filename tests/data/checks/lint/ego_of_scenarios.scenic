scenario Main():
    new Object ahead of ego
    #                   ^^^ SC209 the ego is used before it is set
    ego = new Object
scenario Other():
    new Object ahead of ego
    ego = new Object
scenario Third():
    print(ego)
