#!/usr/bin/env bash
# bundle.sh BUILD FOLDER [EXECUTABLE ...]: makes a folder that runs on a machine with nothing installed but the C
# library, and an NVIDIA driver for --device cuda. Executables go to bin/, libvpm and every shared library that they
# need to lib/, where they are found by their place relative to the executable. Without names it takes the tools and
# control-loop, if they are built. It runs on the devices that BUILD is made for; a build of the preset "cuda" runs on
# all that CMakeLists.txt names, and on later ones.
set -euo pipefail
if [[ $# -lt 2 || ! -d $1/bin ]]; then
  echo "usage: bundle.sh BUILD FOLDER [EXECUTABLE ...]; BUILD is a build tree, like build/cuda" >&2
  exit 2
fi
build=$1 folder=$2
shift 2
names=("$@")
if [[ ${#names[@]} -eq 0 ]]; then
  for name in vpm-pack vpm-graph vpm-normals vpm-query vpm-bench control-loop; do
    [[ ! -x $build/bin/$name ]] || names+=("$name")
  done
fi

# True for libraries that belong to the machine: the C library, which goes with its loader, and the driver.
is_of_the_machine() {
  case $(basename "$1") in
    ld-linux* | libc.so.* | libm.so.* | libdl.so.* | librt.so.* | libpthread.so.* | libcuda.so.*) true ;;
    *) false ;;
  esac
}

mkdir -p "$folder/lib"
plugins=()  # loaded when they are first needed
for name in libvpm_voxels.so libvpm_mesh_plugin.so; do
  [[ ! -e $build/lib/$name ]] || plugins+=("$build/lib/$name")
done
if [[ -e $build/lib/libvpm_voxels.so ]]; then install -m 755 "$build/lib/libvpm_voxels.so" "$folder/lib/"; fi
for name in "${names[@]}"; do
  cmake --install "$build" --component "$name" --prefix "$folder" --strip >/dev/null
  [[ -x $folder/bin/$name ]] || { echo "bundle.sh: $build has nothing to install as '$name'" >&2; exit 1; }
  while read -r library; do
    is_of_the_machine "$library" || install -m 755 "$library" "$folder/lib/"
  done < <(ldd "$build/bin/$name" "${plugins[@]}" | awk '$2 == "=>" && $3 ~ /^\// { print $3 }' | sort -u)
done
find "$folder/lib" -type f -exec strip --strip-unneeded {} +
cuda=$(sed -n 's/^CMAKE_CUDA_ARCHITECTURES:[A-Z]*=//p' "$build/CMakeCache.txt")
echo "$folder: ${#names[@]} executables${cuda:+ for CUDA $cuda}, $(find "$folder/lib" -type f | wc -l) libraries, $(du -sh "$folder" | cut -f1)"
