behavior F():
   precondtion:self.s
   invarant: self.y
