# Shared by tools/first-light and tools/test: what they check for and install. Sourced, not run.
# shellcheck shell=bash

say() {
    printf '==> %s\n' "$*"
}

complain() {
    printf 'error: %s\n' "$*" >&2
}

# Cargo, from the path or from where rustup puts it. The project's rust-toolchain.toml asks for the
# stable toolchain; rustup fetches it by itself.
require_cargo() {
    if ! command -v cargo >/dev/null 2>&1 && [ -x "${CARGO_HOME:-${HOME:-/root}/.cargo}/bin/cargo" ]; then
        PATH="${CARGO_HOME:-${HOME:-/root}/.cargo}/bin:$PATH"
        export PATH
    fi
    if ! command -v cargo >/dev/null 2>&1; then
        complain "cargo was not found; install Rust 1.88 or later as https://rustup.rs says, then run this again"
        return 1
    fi
    if ! cargo --version; then
        complain "cargo does not start; 'rustup toolchain install stable' mends most causes"
        return 1
    fi
}

# rustfmt and clippy. The toolchain file lists them, but a Rust that did not come from rustup, or
# one without network, may lack them.
require_rust_component() {
    local command=$1 component=$2
    if ! cargo "$command" --version >/dev/null 2>&1; then
        complain "this Rust toolchain lacks $component; run 'rustup component add $component', or install your system's package of that name"
        return 1
    fi
}

have_vulkan_loader() {
    local ldconfig folder
    for ldconfig in ldconfig /sbin/ldconfig /usr/sbin/ldconfig; do
        if command -v "$ldconfig" >/dev/null 2>&1; then
            # Not 'ldconfig | grep -q', which fails under pipefail when grep is done first.
            case $("$ldconfig" -p 2>/dev/null) in *libvulkan.so.1*) return 0 ;; esac
        fi
    done
    for folder in /usr/lib /usr/lib64 /usr/local/lib /lib /usr/lib/*-linux-gnu*; do
        if [ -e "$folder/libvulkan.so.1" ]; then return 0; fi
    done
    return 1
}

# Whether one of the given folders and files names a file that ends in .json.
have_manifest() {
    local place file
    for place in "$@"; do
        for file in "$place" "$place"/*.json; do
            if [ -f "$file" ]; then return 0; fi
        done
    done
    return 1
}

# The folders where the loader looks for the given kind: icd.d (drivers) or explicit_layer.d.
vulkan_folders() {
    printf '%s\n' "/etc/vulkan/$1" "/usr/local/etc/vulkan/$1" "/usr/local/share/vulkan/$1" \
        "/usr/share/vulkan/$1" "${XDG_CONFIG_HOME:-${HOME:-/root}/.config}/vulkan/$1" \
        "${XDG_DATA_HOME:-${HOME:-/root}/.local/share}/vulkan/$1"
}

have_vulkan_driver() {
    local places chosen="${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}"
    if [ -n "$chosen" ]; then
        IFS=: read -r -a places <<<"$chosen"
    else
        mapfile -t places < <(vulkan_folders icd.d)
    fi
    have_manifest "${places[@]}"
}

have_validation_layer() {
    local place folders
    if [ -n "${VK_LAYER_PATH:-}" ]; then
        IFS=: read -r -a folders <<<"$VK_LAYER_PATH"
    else
        mapfile -t folders < <(vulkan_folders explicit_layer.d)
    fi
    for place in "${folders[@]}"; do
        if [ -f "$place/VkLayer_khronos_validation.json" ]; then return 0; fi
    done
    return 1
}

# What stops the programs here from using Vulkan, as Debian's package names, one a line. With the
# argument 'validation', the layer that the tests use too.
missing_packages() {
    if ! have_vulkan_loader; then echo libvulkan1; fi
    if ! have_vulkan_driver; then echo mesa-vulkan-drivers; fi
    if [ "${1:-}" = validation ] && ! have_validation_layer; then echo vulkan-validationlayers; fi
}

# Runs a command with root rights, or fails without asking where nobody can answer.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif sudo -n true 2>/dev/null || [ -t 0 ]; then
        sudo "$@"
    else
        return 1
    fi
}

can_become_root() {
    [ "$(id -u)" -eq 0 ] && return 0
    command -v sudo >/dev/null 2>&1 || return 1
    sudo -n true 2>/dev/null || [ -t 0 ]
}

# Makes sure that Vulkan is there: installs what is missing where that is possible. Fails, having
# said which packages are wanted, where it is not. The argument is that of missing_packages.
ensure_vulkan() {
    if [ "$(uname -s)" != Linux ]; then
        if have_vulkan_driver_elsewhere; then
            say "Vulkan: found"
            return 0
        fi
        say "Vulkan: not found; on macOS, MoltenVK (in the Vulkan SDK, or 'brew install molten-vk vulkan-loader') provides it"
        return 1
    fi
    local missing
    mapfile -t missing < <(missing_packages "${1:-}")
    if [ "${#missing[@]}" -eq 0 ]; then
        say "Vulkan: loader and driver found, nothing to install"
        return 0
    fi
    if ! command -v apt-get >/dev/null 2>&1; then
        say "Vulkan: no apt-get here; install your system's counterparts of Debian's packages ${missing[*]}"
        return 1
    fi
    if ! can_become_root; then
        say "Vulkan: no root rights to install the packages ${missing[*]}; ask an administrator for: apt-get install ${missing[*]}"
        return 1
    fi
    say "Vulkan: installing the packages ${missing[*]} (the only step that uses root rights)"
    as_root apt-get update || say "Vulkan: apt-get update failed; trying with the package lists at hand"
    if ! as_root env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends "${missing[@]}"; then
        say "Vulkan: apt-get did not install ${missing[*]}; its message is above"
        return 1
    fi
    mapfile -t missing < <(missing_packages "${1:-}")
    if [ "${#missing[@]}" -gt 0 ]; then
        say "Vulkan: installed, and still not found: ${missing[*]}; look at VK_DRIVER_FILES, VK_ICD_FILENAMES and VK_LAYER_PATH"
        return 1
    fi
}

# macOS: the loader or MoltenVK itself, in the usual places.
have_vulkan_driver_elsewhere() {
    local folder
    for folder in "${VULKAN_SDK:-/usr/local}/lib" /usr/local/lib /opt/homebrew/lib; do
        if [ -e "$folder/libvulkan.1.dylib" ] || [ -e "$folder/libMoltenVK.dylib" ]; then return 0; fi
    done
    return 1
}
