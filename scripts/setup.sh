#!/usr/bin/env bash
# Finds what this machine lacks to run or to test umbravox, and installs only that.
#
#   scripts/setup.sh run     a Vulkan loader, a Vulkan driver, Rust and a linker
#   scripts/setup.sh test    the same, the Vulkan validation layer and a C++ compiler
#
# Packages are installed through apt-get, as root or with sudo. Where that is impossible, the missing packages are
# named and the exit status is 1. Nothing is downloaded when nothing is missing.
set -euo pipefail
cd "$(dirname "$0")/.."

purpose=${1:-run}
case $purpose in
    run | test) ;;
    *)
        echo "usage: scripts/setup.sh [run|test]" >&2
        exit 2
        ;;
esac

# Folders where loader manifests (drivers, layers) may lie, below which "vulkan/icd.d" and its like are looked up.
manifest_roots() {
    local IFS=:
    printf '%s\n' "${XDG_CONFIG_HOME:-${HOME:-/root}/.config}" ${XDG_CONFIG_DIRS:-/etc/xdg} /etc \
        "${XDG_DATA_HOME:-${HOME:-/root}/.local/share}" ${XDG_DATA_DIRS:-} /usr/local/share /usr/share
}

shared_library() { # NAME: true when the dynamic linker finds it
    local folder folders cache
    IFS=: read -ra folders <<<"${LD_LIBRARY_PATH:-}"
    for folder in "${folders[@]}"; do
        [ -n "$folder" ] && [ -e "$folder/$1" ] && return 0
    done
    cache=$(PATH=$PATH:/sbin:/usr/sbin ldconfig -p 2>/dev/null) || return 1
    [[ $cache == *"$1 "* ]]
}

# A driver counts when its library is there, and so is the hardware: the driver of a graphics card may be installed
# in a container or virtual machine that has none. Mesa's software driver (lavapipe) needs no hardware.
usable_driver() { # MANIFEST
    local library
    library=$(sed -n 's/.*"library_path"[^"]*"\([^"]*\)".*/\1/p' "$1" | head -n 1)
    case $library in
        "") return 1 ;;
        /*) [ -e "$library" ] || return 1 ;;
        */*) [ -e "$(dirname "$1")/$library" ] || return 1 ;;
        *) shared_library "$library" || return 1 ;;
    esac
    case $library in
        *lvp* | *swiftshader*) return 0 ;;
    esac
    compgen -G '/dev/dri/renderD*' >/dev/null || [ -e /dev/nvidiactl ] || [ -e /dev/dxg ]
}

vulkan_driver() {
    local manifest root chosen=${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}
    if [ -n "$chosen" ]; then # the loader then looks nowhere else
        while IFS= read -r manifest; do
            [ -f "$manifest" ] && usable_driver "$manifest" && return 0
        done < <(tr : '\n' <<<"$chosen")
        return 1
    fi
    while IFS= read -r root; do
        for manifest in "$root"/vulkan/icd.d/*.json; do
            [ -f "$manifest" ] && usable_driver "$manifest" && return 0
        done
    done < <(manifest_roots)
    return 1
}

driver_advice() {
    local variable
    for variable in VK_DRIVER_FILES VK_ICD_FILENAMES; do
        if [ -n "${!variable:-}" ]; then
            echo "Vulkan driver ($variable=${!variable} names none that works here)"
            return
        fi
    done
    echo "Vulkan driver (software rendering; a graphics card's own works too)"
}

validation_layer() {
    local root folder folders
    IFS=: read -ra folders <<<"${VK_LAYER_PATH:-}:${VK_ADD_LAYER_PATH:-}"
    while IFS= read -r root; do
        folders+=("$root/vulkan/explicit_layer.d")
    done < <(manifest_roots)
    for folder in "${folders[@]}"; do
        [ -n "$folder" ] && [ -f "$folder/VkLayer_khronos_validation.json" ] && return 0
    done
    return 1
}

links() { # COMPILER LANGUAGE: true when it makes a program
    local source='int main() { return 0; }'
    [ "$2" = c++ ] && source="#include <vector>
$source"
    command -v "$1" >/dev/null && "$1" -x "$2" -o /dev/null - <<<"$source" 2>/dev/null
}

# Lines "package: what it is for" of what is missing.
missing_packages() {
    links cc c || echo "gcc: linker for Rust programs"
    links cc c || echo "libc6-dev: C library to link with"
    shared_library libvulkan.so.1 || echo "libvulkan1: Vulkan loader"
    vulkan_driver || echo "mesa-vulkan-drivers: $(driver_advice)"
    if [ "$purpose" = test ]; then
        validation_layer || echo "vulkan-validationlayers: checks every Vulkan call in the tests"
        links c++ c++ || echo "g++: compiles the optional allocator vk-mem"
    fi
}

# Rust itself is not installed from here: distributions ship older ones.
require_rust() {
    local wanted found
    wanted=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
    if ! command -v cargo >/dev/null; then
        echo "missing: cargo (Rust $wanted or newer, from https://rustup.rs)" >&2
        exit 1
    fi
    found=$(rustc --version | cut -d' ' -f2)
    if [ "$(printf '%s\n' "$wanted" "$found" | sort -V | head -n 1)" != "$wanted" ]; then
        echo "missing: Rust $wanted or newer; $found is here (rustup update stable)" >&2
        exit 1
    fi
}

install() { # PACKAGE…
    local run=()
    if ! command -v apt-get >/dev/null; then
        echo "setup: no apt-get here" >&2
        return 1
    fi
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            echo "setup: not root, and no sudo here" >&2
            return 1
        fi
        # Ask for a password only where somebody can type it.
        run=(sudo)
        [ -t 0 ] || run+=(-n)
    fi
    run+=(env DEBIAN_FRONTEND=noninteractive apt-get)
    echo "setup: installing $*"
    "${run[@]}" install -y -q --no-install-recommends "$@" ||
        { "${run[@]}" update -q && "${run[@]}" install -y -q --no-install-recommends "$@"; }
}

require_rust
missing=$(missing_packages)
[ -z "$missing" ] && exit 0

mapfile -t packages < <(cut -d: -f1 <<<"$missing")
install "${packages[@]}" || true
missing=$(missing_packages)
if [ -n "$missing" ]; then
    echo "missing, and not installed (names of Debian and Ubuntu packages):" >&2
    sed 's/^/  /' <<<"$missing" >&2
    exit 1
fi
