#!/usr/bin/env bash
# Passes the tests: makes sure of an OpenCL device, installing PoCL for the CPU where there is none, then runs cargo test.
# Further arguments go to cargo test.
set -euo pipefail
cd "$(dirname "$0")/.."

energywave() { cargo run --release --quiet -- "$@"; }
has_device() { energywave devices --json 2>/dev/null | grep -q "\"type\": \"$1\""; }

install_pocl() {
    local packages="pocl-opencl-icd ocl-icd-libopencl1"
    if ! command -v apt-get >/dev/null; then
        echo "No OpenCL device. Install PoCL (Fedora: pocl; Arch: pocl; macOS: brew install pocl) or a GPU's OpenCL driver." >&2
        exit 1
    fi
    local as_root=""
    if [ "$(id -u)" != 0 ]; then
        if ! sudo -n true 2>/dev/null; then
            echo "No OpenCL device. Run this, then the tests again: sudo apt-get install $packages" >&2
            exit 1
        fi
        as_root=sudo
    fi
    echo "No OpenCL device: installing $packages"
    $as_root apt-get update -qq
    # shellcheck disable=SC2086 # two packages
    DEBIAN_FRONTEND=noninteractive $as_root apt-get install -y -qq --no-install-recommends $packages
}

cargo build --release --quiet
if [ -z "${ENERGYWAVE_DEVICE:-}" ]; then
    if has_device cpu; then
        export ENERGYWAVE_DEVICE=cpu
    elif has_device gpu; then
        export ENERGYWAVE_DEVICE=gpu
    else
        install_pocl
        has_device cpu || { energywave devices >&2; exit 1; }
        export ENERGYWAVE_DEVICE=cpu
    fi
fi
if [ $# = 0 ] && command -v cargo-nextest >/dev/null; then
    # A process for each test: drivers build kernels side by side, which threads of one process wait for.
    cargo nextest run --release --no-fail-fast --status-level fail --final-status-level slow
    cargo test --release --doc
else
    cargo test --release "$@"
fi
