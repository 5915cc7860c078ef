behavior B():
    precondition: self = None
    finally: pass
