with (follow altitude from
 M & f for self
   ):wait