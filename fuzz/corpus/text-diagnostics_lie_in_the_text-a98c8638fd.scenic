match None:
    case {** _}: pass
