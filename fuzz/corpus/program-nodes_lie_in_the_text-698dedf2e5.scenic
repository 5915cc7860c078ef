for x in * f'{ {} >> Range=}' deg,: pass
