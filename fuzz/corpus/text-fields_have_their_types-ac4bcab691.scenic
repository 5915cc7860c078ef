match:
    case
