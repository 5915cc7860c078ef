ego = new Object ahead of ego by 3
#                         ^^^ SC209 the ego is used before it is set
