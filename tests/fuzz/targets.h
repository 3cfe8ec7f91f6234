// Declares what the table of targets holds.
#pragma once

#include "tests/fuzz/fuzz_target.h"

namespace vpm::fuzz {

// Meshes: parsed, cut into triangles, and, if small, made a solid.
void run_obj(Bytes input);
void run_off(Bytes input);
void run_ply(Bytes input);
void run_stl(Bytes input);
void run_om(Bytes input);
// Takes COLLADA, glTF and FBX, which a process of its own reads, and 3MF.
void run_scene(Bytes input);
// Takes parts of a 3MF package, separated by lines "--": the main model, another one, and settings
// of slicers.
void run_threemf(Bytes input);
// Takes a byte of options and an OBJ file: repaired, welded, packed.
void run_solid(Bytes input);

// Depth images: parsed, and, if small, made a cloud that is queried.
void run_png(Bytes input);
void run_exr(Bytes input);
void run_tiff(Bytes input);
void run_netpbm(Bytes input);
void run_npy(Bytes input);

// Clouds of other formats: imported and queried.
void run_pcd(Bytes input);
void run_ply_points(Bytes input);

// Containers with checksums mended: validated, and queried or made a tool model.
void run_vpmp(Bytes input);
void run_vpmg(Bytes input);
void run_vpmc(Bytes input);
// Containers as they are, of any kind.
void run_container(Bytes input);
// Changes a chunk or the header of a container and puts it together again.
std::size_t mutate_container(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed);

void run_poses(Bytes input);
void run_camera_pose(Bytes input);
void run_intrinsics(Bytes input);
void run_config(Bytes input);
// Takes a byte that chooses the option and its text.
void run_options(Bytes input);
// Takes the files of a folder, separated by lines "--".
void run_recording(Bytes input);
// Takes a recording of ROS 2.
void run_mcap(Bytes input);

}  // namespace vpm::fuzz
