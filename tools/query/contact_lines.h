// Lists of contacts in lines of results.
#pragma once

#include <vpm/query_types.h>

#include <nlohmann/json.hpp>
#include <span>

namespace vpm::tools {

// Returns the list `contacts` of a pair of --pairs, in a unit of so many metres. Volumes and areas
// are those of the API divided once, so that they add up as closely as quotients can.
nlohmann::ordered_json contacts_of_pair(std::span<const Contact> contacts, double metres);

// Returns the list `contacts` of a pose: with the body and what pushes the tool, in metres.
nlohmann::ordered_json contacts_of_pose(std::span<const Contact> contacts);

}  // namespace vpm::tools
