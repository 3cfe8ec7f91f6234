// Reads the file of --joints: the configurations at which the links of a robot are asked.
#pragma once

#include <vpm/robot.h>

#include <set>
#include <string>
#include <vector>

namespace vpm::tools {

struct Configuration {
  std::vector<double> values;  // of Robot::movable, rad or m
  std::string id;              // JSON, as it was given; empty without one
};

// Reads the lines of a file ("-": standard input): each an object of joints' names and values, in
// which joints may be missing, whose values are 0, with an "id" if wanted; or an array of the
// values of all movable joints. Values of fixed joints and of those that mimic others are passed
// over. Throws Error(refused), naming the line, for other lines, names of no joint, and a file
// without any.
std::vector<Configuration> read_configurations(const std::string& path, const Robot& robot,
                                               std::set<std::string>& missing);

}  // namespace vpm::tools
