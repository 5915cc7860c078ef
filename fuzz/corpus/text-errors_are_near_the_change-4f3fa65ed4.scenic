scenario S:
    setup: pass; bottomback left of S
