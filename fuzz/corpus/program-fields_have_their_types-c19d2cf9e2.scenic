match Range:
    case 0: pass
    case 0, (0 | False,) as d: pass
