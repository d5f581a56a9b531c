# The targets are thin: without make, run the scripts.

.PHONY: help demo test figures gallery bench bench-report shaders

help:
	@echo 'make demo      render the CT in data/ into out/'
	@echo 'make test      run every test'
	@echo 'make figures   render docs/figures/, measure docs/results.md and docs/conformance.md'
	@echo 'make gallery   draw every volume at hand into docs/gallery.png'
	@echo 'make bench     measure on this machine, about a minute'
	@echo 'make bench-report   measure for the record, beside VTK, a quarter of an hour; docs/performance.md'
	@echo 'make shaders   compile glsl/ into spirv/ (needs glslc)'
	@echo
	@echo 'demo, test, figures, gallery, bench and bench-report first install what is missing (apt-get, as root or with sudo).'

demo:
	@scripts/demo.sh

test:
	@scripts/test.sh

figures:
	@scripts/figures.sh

gallery:
	@scripts/gallery.sh

bench:
	@scripts/setup.sh run
	cargo bench --bench gpu

bench-report:
	@scripts/bench-report.sh

shaders:
	cargo xtask shaders
