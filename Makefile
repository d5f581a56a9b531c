# The targets are thin: without make, run the scripts.

.PHONY: help demo test figures gallery bench shaders

help:
	@echo 'make demo      render the CT in data/ into out/'
	@echo 'make test      run every test'
	@echo 'make figures   render docs/figures/ and measure docs/results.md'
	@echo 'make gallery   draw every volume at hand into docs/gallery.png'
	@echo 'make bench     measure on this machine'
	@echo 'make shaders   compile glsl/ into spirv/ (needs glslc)'
	@echo
	@echo 'demo, test, figures, gallery and bench first install what is missing (apt-get, as root or with sudo).'

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
	cargo bench

shaders:
	cargo xtask shaders
