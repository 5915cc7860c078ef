match Range:
    case 0 as d: pass
    case 0: d
