"""Definitions of a project's modules, found without running any of them: for ``scenic check`` and for editors.

`index` holds the modules, `module_search` finds them; `symbols` says what a name is, `classes` what a class has, `queries`
what stands at a place and where else it is used. All of it is plain data, free of protocol types.
"""
