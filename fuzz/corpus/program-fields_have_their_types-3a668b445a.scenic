match Range:
    case 0: pass
    case 0: pass
    case False: pass
