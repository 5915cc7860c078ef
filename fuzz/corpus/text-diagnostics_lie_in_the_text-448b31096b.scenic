["\
    workspace