# Everything runs from .venv, which the lock files in requirements/ describe exactly.
# PYTHON may name the interpreter to build it from: make demo PYTHON=python3.12

VENV := .venv
BIN := $(VENV)/bin
BENCH_VENV := .venv-bench
BENCH_BIN := $(BENCH_VENV)/bin

.PHONY: demo test check postgresql serve setup lock docs pictures openapi reports bench bench-quick bench-page bench-service mutants clean

demo: $(VENV)/run.stamp          ## set up, plan data set 3, execute it on simulated servos
	@$(BIN)/prunus demo

ifdef ONLY
test: $(VENV)/dev.stamp postgresql ## some tests: make test ONLY=tests/app/store, or ONLY=solver/motion
	@sh scripts/run_tests.sh $(BIN) $(ONLY)
else
test: check postgresql           ## set up, then every check and every test
	@sh scripts/run_tests.sh $(BIN)
endif

check: $(VENV)/dev.stamp         ## format, lint, types, floors
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

postgresql:                      # APT=1 lets it be installed
	@APT=$(APT) sh scripts/postgresql.sh

serve: $(VENV)/run.stamp         ## the service, on loopback
	@$(BIN)/prunus serve

setup: $(VENV)/dev.stamp postgresql ## the environment alone

pictures: $(VENV)/run.stamp      ## README's pictures and table, from the demo
	$(BIN)/prunus demo --output build/pictures
	cp build/pictures/arm.png build/pictures/effort.png build/pictures/table.md docs/pictures/
	$(BIN)/python -m app.reports.drawings.weights docs/pictures/weights.png
	$(BIN)/python -m app.reports.drawings.strawberry docs/pictures/strawberry.png
	$(BIN)/python -m scripts.update_readme

reports: $(VENV)/run.stamp       ## the example reports in docs/reports, measured anew on a quiet machine
	$(BIN)/prunus compare strawberry --output docs/reports/strawberry
	$(BIN)/prunus compare data-set-3 --output docs/reports/data-set-3

docs: $(VENV)/dev.stamp          ## drawing and tables of rooms, index of decisions, from the code
	$(BIN)/python -m scripts.update_docs

openapi: $(VENV)/run.stamp       ## openapi/openapi.json, from the code
	$(BIN)/prunus export-openapi -o openapi/openapi.json

bench: $(BENCH_VENV)/bench.stamp ## every benchmark into bench/results, or some: make bench ONLY="ssas given"
	$(BENCH_BIN)/python -m bench $(addprefix --only ,$(ONLY))
	$(BENCH_BIN)/python -m bench.page

bench-quick: $(BENCH_VENV)/bench.stamp ## the same with small sets, into build/bench
	$(BENCH_BIN)/python -m bench --quick $(addprefix --only ,$(ONLY))

bench-service: $(VENV)/dev.stamp ## a live service under load, fuzzed and killed: hours
	@failed=0; for part in load fuzz kills; do \
		$(BIN)/python -m bench.service.$$part || failed=1; done; exit $$failed

mutants: $(VENV)/dev.stamp       ## what changes no test notices, a quarter of an hour a room: make mutants ONLY=solver/methods
	$(BIN)/python -m bench.mutants $(ONLY)

bench-page: $(BENCH_VENV)/bench.stamp ## docs/benchmarks.md and its plots, from bench/results
	$(BENCH_BIN)/python -m bench.page

$(VENV)/run.stamp: requirements/run.lock pyproject.toml scripts/setup.sh
	@APT=$(APT) sh scripts/setup.sh $(VENV) requirements/run.lock
	@touch $@

$(VENV)/dev.stamp: requirements/dev.lock pyproject.toml scripts/setup.sh
	@APT=$(APT) sh scripts/setup.sh $(VENV) requirements/dev.lock
	@touch $@ $(VENV)/run.stamp

$(BENCH_VENV)/bench.stamp: requirements/bench.lock pyproject.toml scripts/setup.sh
	@APT=$(APT) sh scripts/setup.sh $(BENCH_VENV) requirements/bench.lock
	@touch $@

LOCK := uv pip compile --universal --python-version 3.11 --generate-hashes --no-annotate \
	--no-emit-index-url --no-emit-find-links --custom-compile-command "make lock"

lock:                            ## all lock files anew (needs uv)
	$(LOCK) pyproject.toml --group dev -o requirements/dev.lock
	$(LOCK) pyproject.toml --group install -c requirements/dev.lock -o requirements/run.lock
	$(LOCK) pyproject.toml --group bench -c requirements/dev.lock -o requirements/bench.lock

clean:
	rm -rf $(VENV) $(BENCH_VENV) build dist *.egg-info .mypy_cache .ruff_cache .pytest_cache .import_linter_cache
