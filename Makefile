# The two commands of the README are `make demo` and `make test`; both make .venv when it is missing.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: demo test test-fast test-long lint types fuzz semantics generate docs docs-serve dist playground extension pythons robosuite clean

# Modules are compiled when they are first imported: most of the packages' modules never are.
$(STAMP): pyproject.toml hatch_build.py
	$(PYTHON) -c 'import sys; sys.exit("Scenic needs Python 3.11 or newer; this is " + sys.version.split()[0]) if sys.version_info < (3, 11) else None'
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install -q --disable-pip-version-check --no-compile -e '.[dev]'
	touch $@

demo: $(STAMP)
	$(BIN)/python -m examples.demo out

# All tests, in one session whose workers take waiting tests from each other.
test: $(STAMP)
	$(BIN)/python -m pytest -q -n auto --dist worksteal

# What a change needs before it is committed.
test-fast: $(STAMP)
	$(BIN)/python -m pytest -q -n auto --dist worksteal -m 'not slow'

# All tests with more cases, samples and seeds: what finds rare faults.
test-long: $(STAMP)
	SCENIC_TEST_LONG=1 $(BIN)/python -m pytest -q -n auto --dist worksteal

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(STAMP)
	$(BIN)/mypy

fuzz: $(STAMP)
	$(BIN)/python -m fuzz $(if $(MINUTES),--minutes $(MINUTES)) $(FUZZ)

# Typed programs, from text to scenes and simulations.
semantics: $(STAMP)
	$(BIN)/python -m fuzz.semantics --programs $(or $(PROGRAMS),500) --jobs 2 $(if $(SEED),--seed $(SEED))

# After a change of grammar/scenic.gram or scenic/language: makes the parser again (imports notice a stale one too), and
# what editors and docs/reference/syntax.md take from the grammar.
generate: $(STAMP)
	$(BIN)/python -m grammar.generator
	$(BIN)/python -m editors.generate

# The documentation, in docs/_build/html; builds offline, and every warning is an error.
docs: $(STAMP)
	$(BIN)/python -m sphinx -b html -q -W --keep-going -d docs/_build/doctrees docs docs/_build/html

docs-serve: docs
	$(BIN)/python -m http.server --bind 127.0.0.1 --directory docs/_build/html 8000

# Robosuite in build/robosuite, since it wants an old MuJoCo, and the tests that need it.
robosuite: build/robosuite/.installed
	build/robosuite/bin/python -m pytest -q -p no:cacheprovider -W ignore tests/simulators/test_robosuite.py

build/robosuite/.installed: pyproject.toml
	test -x build/robosuite/bin/python || $(PYTHON) -m venv build/robosuite
	build/robosuite/bin/python -m pip install -q --disable-pip-version-check -e '.[robosuite]' coacd hypothesis pytest
	build/robosuite/bin/python -m pip install -q --disable-pip-version-check --no-deps robosuite==1.5.2
	touch $@

# Wheel and sdist in dist/: checked, and the wheel installed in an empty environment, where it samples a scene and has the
# page of the playground.
dist: $(STAMP) playground
	rm -rf dist build/empty
	$(BIN)/python -m build --outdir dist
	$(BIN)/python -m twine check --strict dist/*
	$(PYTHON) -m venv build/empty
	build/empty/bin/python -m pip install -q --disable-pip-version-check "$$(echo dist/*.whl)[playground]"
	cd build/empty && bin/scenic new started && bin/scenic sample started/scene.scenic -n 2 --seed 1 -o scenes.jsonl
	build/empty/bin/python -c "from scenic.playground.server import is_built; assert is_built()"
	tar -tzf dist/*.tar.gz | grep -q 'scenic/playground/static/page.js'

# The page of `scenic playground`, which wheels carry; needs npm.
PAGE := scenic/playground/static/page.js
playground: $(PAGE)

$(PAGE): editors/playground/package-lock.json editors/playground/build.mjs $(wildcard editors/playground/src/*)
	cd editors/playground && npm ci --silent && npm run --silent build

# The extension for Visual Studio Code, editors/vscode/scenic.vsix; needs npm.
extension:
	cd editors/vscode && npm ci --silent && npm run --silent package

# Later versions of CPython as WebAssembly, for tests/test_pythons.py; needs npm.
pythons:
	cd tests/pythons && npm ci --silent

clean:
	rm -rf $(VENV) build dist out docs/_build scenic/compiler/_generated scenic/playground/static .mypy_cache .ruff_cache .pytest_cache .hypothesis
