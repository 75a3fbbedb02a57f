#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# installed.sh BUILD: installs into folders of its own, runs what is there as it is, and builds and
# runs a foreign program against it, by pkg-config and by CMake.
set -euo pipefail
build=$(cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset LD_LIBRARY_PATH DESTDIR

fail() {
  echo "$*"
  exit 1
}

# installed_whole PREFIX PATH: everything is below PREFIX and speaks of PATH, where it will be.
installed_whole() {
  local prefix=$1 path=$2 file
  for file in bin/iio-angle include/ada4571.h share/man/man1/iio-angle.1 \
    share/bash-completion/completions/iio-angle share/zsh/site-functions/_iio-angle \
    share/fish/vendor_completions.d/iio-angle.fish lib/udev/rules.d/60-ada4571.rules \
    lib/udev/ada4571-permissions lib/systemd/system/ada4571-{gc,pd}@.service \
    share/doc/libada4571/{LICENSE,README.md,NEWS.md,docs/index.md,examples/{read_angle.c,tutorial.py}}; do
    [[ -e $prefix/$file ]] || fail "not installed: $file"
  done
  [[ $(find "$prefix/include" -type f | wc -l) == 1 ]] || fail "more than one header"
  dead_links "$prefix"
  grep -q "program}=\"$path/lib/udev/ada4571-permissions" "$prefix"/lib/udev/rules.d/*.rules ||
    fail "the rules do not call the helper in $path"
  for file in "$prefix"/lib/systemd/system/*.service; do
    grep -q "^ExecStart=$path/bin/iio-angle " "$file" || fail "$file does not start $path/bin/iio-angle"
  done
}

# What a page links to is installed, where the page says; but for what is made for the site alone:
# catalogue, reference, and pictures that the commands of a page draw.
dead_links() {
  local pages page link
  mapfile -t pages < <(find "$1/share/doc/libada4571" -name '*.md')
  ((${#pages[@]} > 20)) || fail "only ${#pages[@]} pages are installed"
  for page in "${pages[@]}"; do
    while read -r link; do
      [[ -e $(dirname "$page")/${link%%#*} ]] || fail "${page#"$1/"} links to $link"
    done < <(grep -oE '\]\([^):#][^):]*\)' "$page" | sed 's/^](//; s/)$//' |
      grep -vE '(^|/)catalogue/|^reference/(python|manual|pages)\.md|^c-api/|^[a-z]+\.svg$|^report\.html$')
  done
}

has_rpath() {
  [[ $(readelf -d "$1") == *'PATH)'* ]]
}

touch "$work/began"
# As a user installs it, root or not, by a path from where he stands.
(cd "$work" && cmake --install "$build" --prefix own >install.log)
installed_whole "$work/own" "$work/own"
"$work/own/bin/iio-angle" --version
mv "$work/own" "$work/moved"
"$work/moved/bin/iio-angle" --version >/dev/null || fail "a moved tree does not start"

package=$(find "$work/moved" -path '*/ada4571/__init__.py')
if [[ -n $package ]]; then
  PYTHONPATH=$(dirname "$(dirname "$package")") /usr/bin/python3 -B -c 'import ada4571
assert len(ada4571.Simulation().record(0.1)) == 1000' || fail "a moved Python package does not start"
fi

# As a package: nothing beside /usr, and nothing that a loader must be told.
DESTDIR=$work/package cmake --install "$build" --prefix /usr >"$work/package.log"
installed_whole "$work/package/usr" /usr
[[ $(ls "$work/package") == usr ]] || fail "a package also has: $(ls "$work/package")"
! has_rpath "$work/package/usr/bin/iio-angle" || fail "a packaged program has an RPATH"
has_rpath "$work/moved/bin/iio-angle" || fail "RPATHs are not seen"
rm -rf "$work/package" # an installed tree of a development build is large, and /tmp may be small

# The build folder may be another user's.
written=$(find "$build" "$build/udev" -maxdepth 1 -name '[a-z]*' -newer "$work/began" -type f)
[[ -z $written ]] || fail "installing writes into the build folder: $written"
# Another one's who has nothing but may read it: as root, where nobody may, it is tried.
as_nobody=(setpriv --reuid=65534 --regid=65534 --clear-groups)
if ((EUID == 0)) && "${as_nobody[@]}" test -r "$build/cmake_install.cmake"; then
  install -d -o 65534 -g 65534 "$work/nobody"
  chmod 711 "$work"
  (cd "$work/nobody" && HOME=$work/nobody "${as_nobody[@]}" cmake --install "$build" --prefix own >install.log) ||
    fail "an ordinary user cannot install"
  installed_whole "$work/nobody/own" "$work/nobody/own"
  [[ $(ls "$work/nobody") == $'install.log\nown' ]] || fail "beside the prefix: $(ls "$work/nobody")"
  "${as_nobody[@]}" "$work/nobody/own/bin/iio-angle" --version >/dev/null || fail "it does not start for nobody"
  rm -rf "$work/nobody"
fi

prefix=$work/moved
library=$(dirname "$(find "$prefix" -name libada4571.so)")
export PKG_CONFIG_PATH=$library/pkgconfig
[[ $(pkg-config --modversion libada4571) == 1.0.0 ]]
# shellcheck disable=SC2046
cc -std=c99 -pedantic-errors -Wall -Werror $(pkg-config --cflags libada4571) \
  "$here/consumer/consumer.c" -o "$work/by-pkg-config" $(pkg-config --libs libada4571)
# A foreign program is told where the library is, as by ldconfig.
first=$(LD_LIBRARY_PATH=$library "$work/by-pkg-config")

cmake -G Ninja -S "$here/consumer" -B "$work/by-cmake" -DCMAKE_PREFIX_PATH="$prefix" >"$work/cmake.log"
cmake --build "$work/by-cmake" >>"$work/cmake.log"
second=$("$work/by-cmake/consumer")
[[ $first == "$second" ]] || fail "two builds, two results: $first, $second"
echo "installed, built twice, both say $first deg"
