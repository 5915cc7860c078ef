behavior simulator(p:
     Range):lambda z3