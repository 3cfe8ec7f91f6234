#!/usr/bin/env bash
# PCL 1.13: loadPLYFile() of double coordinates into PointNormal returns success with all coordinates 0.
# Expected: x, y and z of type double are converted to the float members, as the normals beside them are taken, or an error is returned.
# Seen: it returns 0 and prints "Failed to find match for field 'x'"; the points lie at the origin, their normals are right.
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
debian libpcl-io1.13=1.13.0+dfsg-3 libeigen3-dev libboost-dev -- libpcl-dev=1.13.0+dfsg-3
run_cpp -isystem "$work/root/usr/include/pcl-1.13" -lpcl_io -lpcl_io_ply -lpcl_common <<'CPP'
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>
#include <cstdio>
#include <fstream>
#include <string>

pcl::PointNormal last_point(const std::string& type, int& returned) {
  std::ofstream file("points.ply");
  file << "ply\nformat ascii 1.0\nelement vertex 2\n";
  for (const char* name : {"x", "y", "z"}) file << "property " << type << ' ' << name << '\n';
  for (const char* name : {"nx", "ny", "nz"}) file << "property float " << name << '\n';
  file << "end_header\n1 2 3 0 0 1\n4 5 6 0 0 1\n";
  file.close();
  pcl::PointCloud<pcl::PointNormal> cloud;
  returned = pcl::io::loadPLYFile("points.ply", cloud);
  return cloud.at(1);
}

int main() {
  int of_float = -1, of_double = -1;
  const pcl::PointNormal a = last_point("float", of_float), b = last_point("double", of_double);
  printf("PCL %s: the point 4 5 6 is %g %g %g from floats (returned %d) and %g %g %g from doubles (returned %d), normal %g %g %g\n",
         PCL_VERSION_PRETTY, a.x, a.y, a.z, of_float, b.x, b.y, b.z, of_double, b.normal_x, b.normal_y, b.normal_z);
  return of_float == 0 && a.x == 4 && a.z == 6 && of_double == 0 && b.x == 0 && b.y == 0 && b.z == 0 && b.normal_z == 1 ? 0 : 1;
}
CPP
