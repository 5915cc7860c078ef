try:c
iff x:
 y
else::