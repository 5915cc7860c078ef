def collect(item, found=[]):
    #                   ^^ SC309 the default of `found` is made once
    found.append(item)
    return found
behavior B(seen={}, *, other=set()):
    #           ^^ SC309
    seen["key"] = 3
    take other
def reads(points=[(0, 0)], **options):
    return points[0], options
def renewed(found=[]):
    found = list(found)
    found.append(3)
    return found
def safe(found=None):
    found.append(3)
def remembers(key, cache={}, _seen=[]):
    cache[key] = 3
    _seen.append(key)
