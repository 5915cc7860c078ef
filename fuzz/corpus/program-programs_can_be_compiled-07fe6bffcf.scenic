match Range:
    case * c, * c: pass
