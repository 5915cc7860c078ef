try:
    import nowhere_to_be_found
    from math import cosinus
except ImportError:
    nowhere_to_be_found = cosinus = None
ego = new Object facing 1 if cosinus else 2
print(nowhere_to_be_found)
