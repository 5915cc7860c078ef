f'{Range can see 2.5=}{None&front of Range!r}{Range^Range deg=}';pass
