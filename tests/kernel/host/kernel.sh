# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
# shellcheck shell=bash
#
# From Debian's packages to something that boots. Everything lands in $KERNEL_CACHE/VERSION and is
# made once; a finished step leaves a file of its name there.

# Kernel sources that Debian's image may lack, and the module each makes.
declare -A DRIVER_SOURCES=(
  [industrialio-configfs]=drivers/iio/industrialio-configfs.c
  [industrialio-sw-trigger]=drivers/iio/industrialio-sw-trigger.c
  [iio-trig-hrtimer]=drivers/iio/trigger/iio-trig-hrtimer.c
  [irqsim]=kernel/irq/irq_sim.c
  [gpio-sim]=drivers/gpio/gpio-sim.c
)
DRIVER_ORDER=(industrialio-configfs industrialio-sw-trigger iio-trig-hrtimer irqsim gpio-sim)

step() {
  local name=$1
  shift
  [[ -e $KERNEL/$name.done ]] && return 0
  "$@"
  touch "$KERNEL/$name.done"
}

# What tests/prepare has left in the cache.
the_download() {
  downloaded "$1" "$KERNEL_PACKAGE_VERSION" ||
    refuse "$1 $KERNEL_PACKAGE_VERSION is not in $KERNEL_CACHE: run tests/prepare"
}

unpack_image() {
  local deb
  deb=$(the_download "linux-image-$VERSION")
  rm -rf "$KERNEL/image"
  dpkg-deb -x "$deb" "$KERNEL/image"
  mkdir -p "$KERNEL/image/lib"
  [[ -d $KERNEL/image/lib/modules ]] || mv "$KERNEL/image/usr/lib/modules" "$KERNEL/image/lib/modules"
  depmod -b "$KERNEL/image" "$VERSION"
}

unpack_drivers() {
  local deb
  deb=$(the_download "linux-source-$KERNEL_SERIES")
  unpack_source "$deb" "$KERNEL/source" '*/scripts/extract-vmlinux' '*/drivers/gpio/gpiolib.h' \
    '*/drivers/gpio/dev-sync-probe.h' "${DRIVER_SOURCES[@]/#/*/}"
  [[ -e $KERNEL/source/scripts/extract-vmlinux ]] || refuse "no kernel source in $deb"
}

build_modules() {
  make -s -C "/usr/src/linux-headers-$VERSION" M="$1" "${@:2}" modules >"$1/make.log" 2>&1 ||
    { cat "$1/make.log" >&2; refuse "the modules in $1 do not build"; }
}

build_drivers() {
  local build=$KERNEL/drivers name missing=()
  rm -rf "$build"
  cp -r "$HERE/drivers" "$build"
  for name in "${DRIVER_ORDER[@]}"; do
    find "$KERNEL/image/lib/modules" -name "$name.ko*" | grep -q . && continue
    missing+=("$name")
    cp "$KERNEL/source/${DRIVER_SOURCES[$name]}" "$build/"
  done
  cp "$KERNEL"/source/drivers/gpio/*.h "$build/"
  build_modules "$build" ADA4571_DRIVERS="${missing[*]}"
}

# Our own module is made anew when its source changes; a warning is a failure.
build_replay() {
  local build=$KERNEL/replay
  if [[ -e $build/ada4571_replay.ko ]] && diff -q "$HERE/module/ada4571_replay.c" \
      "$build/ada4571_replay.c" >/dev/null; then
    return 0
  fi
  rm -rf "$build"
  cp -r "$HERE/module" "$build"
  build_modules "$build" W=1 KCFLAGS=-Werror
}

extract_kernel() {
  bash "$KERNEL/source/scripts/extract-vmlinux" "$KERNEL/image/boot/vmlinuz-$VERSION" \
    >"$KERNEL/vmlinux" && [[ -s $KERNEL/vmlinux ]] || refuse "cannot unpack vmlinuz-$VERSION"
}

# busybox and what it takes to mount the machine's own root by 9p.
build_initramfs() {
  local root=$KERNEL/initramfs module file
  rm -rf "$root"
  mkdir -p "$root"/{bin,dev,proc,sys,new,modules}
  cp "$(command -v busybox)" "$root/bin/busybox"
  cp "$HERE/guest/init" "$root/init"
  for module in virtio_pci 9pnet_virtio 9p virtio_net; do
    modprobe -d "$KERNEL/image" -S "$VERSION" --show-depends "$module"
  done | awk '$1 == "insmod" && !seen[$2]++ {print $2}' >"$root/modules/paths"
  while read -r file; do
    module=$(basename "${file%.xz}")
    case $file in
      *.xz) xz -dc "$file" >"$root/modules/$module" ;;
      *) cp "$file" "$root/modules/$module" ;;
    esac
    echo "$module"
  done <"$root/modules/paths" >"$root/modules/order"
  (cd "$root" && find . | cpio -o -H newc --quiet --reproducible) >"$KERNEL/initramfs.cpio"
}

prepare_kernel() {
  KERNEL=$KERNEL_CACHE/$VERSION
  mkdir -p "$KERNEL"
  step image unpack_image
  step source unpack_drivers
  step drivers build_drivers
  step vmlinux extract_kernel
  build_replay
  build_initramfs
}
