#!/usr/bin/env bash
# Make .venv: ROS 2 Jazzy wheels, this package (editable), and msd_interfaces built into it.
#
#   tools/setup.sh             do what is missing; nothing when nothing is
#   tools/setup.sh --missing   print the system packages that are missing, for apt-get install
#
# A step is done when its stamp in .venv/.setup names the step's present inputs. A step that was cut off has no stamp
# and is done again. PYTHON=... chooses the interpreter; LOCK= (empty) takes the newest packages, not the locked ones.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
ROOT=$PWD
VENV=$ROOT/.venv
STAMPS=$VENV/.setup
LOCK=${LOCK-requirements/lock.txt}

# A sourced ROS installation and the wheels do not mix.
unset AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH LD_LIBRARY_PATH PYTHONPATH PYTHONHOME _ROS_WHEELS_BOOTSTRAP_COMPLETE

say() { printf 'setup: %s\n' "$*" >&2; }
fail() { say "$*"; exit 2; }

python_fits() { "$1" -c 'import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null; }
python_has_venv() { "$1" -c 'import venv, ensurepip' 2>/dev/null; }
python_has_headers() {
    "$1" -c 'import os, sys, sysconfig; sys.exit(not os.path.exists(sysconfig.get_path("include") + "/Python.h"))' 2>/dev/null
}

# The first interpreter with everything, else the first that fits at all.
choose_python() {
    local candidate first=
    for candidate in ${PYTHON:-python3 python3.12 python3.11 python3.13 python3.10 python3.14 /usr/bin/python3}; do
        python_fits "$candidate" || continue
        if python_has_venv "$candidate" && python_has_headers "$candidate"; then
            echo "$candidate"
            return
        fi
        first=${first:-$candidate}
    done
    echo "$first"
}

# Names of Debian and Ubuntu packages.
missing_packages() {
    local python=$1 packages=()
    [ -n "$python" ] || packages+=(python3 python3-venv python3-dev)
    [ -z "$python" ] || python_has_venv "$python" || packages+=(python3-venv)
    [ -z "$python" ] || python_has_headers "$python" || packages+=(python3-dev)
    command -v "${CC:-cc}" >/dev/null && command -v "${CXX:-c++}" >/dev/null || packages+=(g++)
    command -v make >/dev/null || packages+=(make)
    echo "${packages[*]}"
}

check_machine() {
    [ "$(uname -s)-$(uname -m)" = Linux-x86_64 ] ||
        fail "this is $(uname -s) on $(uname -m), and the ROS wheels are for Linux on x86_64; build with colcon on a ROS installation instead"
    local missing
    missing=$(missing_packages "$1")
    [ -z "$missing" ] || fail "missing on this machine: $missing; install with: apt install $missing"
}

# Sources of what is compiled for this user.
compiled() { find msd_ident/model msd_ident/compiled msd_sim -name '*.py'; grep -rl --include='*.py' '^@njit' msd_ident; }

inputs() { cat "$@" | sha256sum | cut -d' ' -f1; }
done_with() { [ "$(cat "$STAMPS/$1" 2>/dev/null)" = "$2" ]; }
mark() { mkdir -p "$STAMPS" && echo "$2" >"$STAMPS/$1"; }

make_venv() {
    # What was cut off before it had pip is made anew; a .venv that works is kept, whoever made it.
    [ -x "$VENV/bin/pip" ] && "$VENV/bin/python" -m pip --version >/dev/null 2>&1 || "$1" -m venv --clear "$VENV"
}

# A package whose installation was cut off looks installed to pip as soon as its METADATA is there; RECORD comes last.
drop_cut_off_packages() {
    local info
    for info in "$VENV"/lib/python3.*/site-packages/*.dist-info; do
        [ -e "$info/RECORD" ] || [ ! -d "$info" ] || rm -rf "$info"
    done
}

install_packages() {
    local constraint=()
    # The lock is for the Pythons that its newest packages still support.
    if [ -n "$LOCK" ] && "$VENV/bin/python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
        constraint=(-c "$LOCK")
    fi
    drop_cut_off_packages
    "$VENV/bin/python" -m pip install -qq --disable-pip-version-check --no-input "${constraint[@]}" \
        -r requirements/ros-jazzy.txt -r requirements/colcon.txt -e '.[batch,docs,live,test]' >&2 ||
        fail "pip could not install the packages (its words are above); run again, or with LOCK= for the newest ones"
}

build_interfaces() {
    local build=$ROOT/build/venv/msd_interfaces log=$ROOT/build/venv/msd_interfaces.log
    mkdir -p "$build"
    # Settings of another .venv or of a cut-off run must not survive.
    rm -f "$build/CMakeCache.txt"
    (
        export AMENT_PREFIX_PATH=$VENV CMAKE_PREFIX_PATH=$VENV LD_LIBRARY_PATH=$VENV/lib PATH=$VENV/bin:$PATH
        cmake -S msd_interfaces -B "$build" -DCMAKE_INSTALL_PREFIX="$VENV" -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF \
            -DCMAKE_PROJECT_INCLUDE="$ROOT/cmake/fix_wheels.cmake" &&
            cmake --build "$build" --parallel "$(nproc)" && cmake --install "$build"
    ) >"$log" 2>&1 || { tail -n 20 "$log" >&2; fail "msd_interfaces did not build; all of its output is in $log"; }
}

# What `colcon build` would lay out, as links: ros2 run, ros2 launch and launch_ros find nodes, launch files and parameters.
# Links to files, since ros2 launch does not look into folders that are links.
link_share() {
    local share=$VENV/share/msd_ident index=$VENV/share/ament_index/resource_index/packages nodes=$VENV/lib/msd_ident
    mkdir -p "$index" "$nodes" "$share/launch" "$share/config"
    ln -sf "$ROOT/resource/msd_ident" "$index/"
    ln -sf "$ROOT/package.xml" "$share/"
    ln -sf "$ROOT"/launch/*.py "$share/launch/"
    ln -sf "$ROOT"/config/*.yaml "$share/config/"
    ln -sf ../../bin/{msd,rig,identifier,recorder,replayer,experimenter,live} "$nodes/"
}

set_up() {
    local packages interfaces solver python
    packages=$( (echo "$ROOT $LOCK"; cat setup.py setup.cfg package.xml requirements/*.txt) | inputs -)
    interfaces=$( (echo "$ROOT $LOCK"; cat requirements/*.txt; find msd_interfaces cmake -type f | LC_ALL=C sort | xargs cat) | inputs -)
    solver=$( (echo "$packages"; compiled | LC_ALL=C sort -u | xargs cat) | inputs -)
    if done_with packages "$packages" && done_with interfaces "$interfaces" && done_with solver "$solver" &&
        [ -x "$VENV/bin/msd" ]; then
        link_share  # files may be new
        return
    fi
    mkdir -p build
    exec 9>build/.setup.lock
    flock 9
    python=$(choose_python)
    check_machine "$python"
    if ! done_with packages "$packages" || [ ! -x "$VENV/bin/msd" ]; then
        say "packages into .venv with $("$python" -V) (about a minute)"
        make_venv "$python"
        install_packages
        link_share
        mark packages "$packages"
    fi
    if ! done_with interfaces "$interfaces"; then
        say "building msd_interfaces (about half a minute)"
        build_interfaces
        mark interfaces "$interfaces"
    fi
    if ! done_with solver "$solver"; then
        # Once for this user; without it the first fit compiles.
        "$VENV/bin/msd" warm
        mark solver "$solver"
    fi
    say "done"
}

case "${1:-}" in
    "") set_up ;;
    --missing) missing_packages "$(choose_python)" ;;
    *) fail "unknown argument $1; expected none, or --missing" ;;
esac
