#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>
#include <vpm/robot.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <system_error>

#include "libvpm/core/error.h"
#include "libvpm/core/vec3.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/robot/xml_file.h"

namespace vpm {
namespace {

namespace fs = std::filesystem;

// Collects what urdfdom says, which goes to a log that all of a process have.
class Listener : public console_bridge::OutputHandler {
 public:
  Listener() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~Listener() { console_bridge::restorePreviousOutputHandler(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_.empty()) first_ = text;
  }
  // Returns what was said first, which is the cause of the rest.
  const std::string& first() const { return first_; }

 private:
  static std::mutex& mutex() {
    static std::mutex all;
    return all;
  }
  std::lock_guard<std::mutex> lock_;
  std::string first_;
};

class Reader {
 public:
  Reader(const std::string& path, const RobotOptions& options) : path_(path), options_(options) {}

  Robot read() {
    const std::string text = text_of_xml(path_);
    if (text.find("<xacro:") != text.npos || text.find("xmlns:xacro") != text.npos)
      refuse("this is xacro, of which URDF is made", path_,
             "run: xacro " + path_ + " > robot.urdf");
    const XmlFile file(path_, text, "robot", "a URDF file");
    check_circles(file);
    const urdf::ModelInterfaceSharedPtr model = parsed(text);
    check_collisions(file, *model);
    robot_.name = model->getName();
    add_link(*model->getRoot());
    list_movable(file);
    resolve_mimics();
    check_shapes();
    return std::move(robot_);
  }

 private:
  urdf::ModelInterfaceSharedPtr parsed(const std::string& text) const {
    const Listener listener;
    try {
      if (auto model = urdf::parseURDF(text); model && model->getRoot()) return model;
    } catch (const std::exception& fault) {
      refuse(file::shown(fault.what()), path_, "check_urdf (Debian: liburdfdom-tools) says more");
    }
    refuse(listener.first().empty() ? "urdfdom reads no robot" : file::shown(listener.first()),
           path_, "check_urdf (Debian: liburdfdom-tools) says more");
  }

  // Throws Error(refused) if a link is its own ancestor, which urdfdom tells as a missing root
  // only.
  void check_circles(const XmlFile& file) const {
    std::map<std::string, std::string> parent_of;
    for (const TiXmlElement* joint : file.children("joint")) {
      const TiXmlElement* child = joint->FirstChildElement("child");
      const TiXmlElement* parent = joint->FirstChildElement("parent");
      if (child == nullptr || parent == nullptr) continue;
      const std::string name = attribute(*child, "link");
      if (!parent_of.try_emplace(name, attribute(*parent, "link")).second)
        refuse("two joints lead to link '" + file::shown(name) + "'", path_,
               "a link has one parent: remove the joint that closes the loop");
    }
    for (const auto& [start, ignored] : parent_of) {
      std::set<std::string> seen{start};
      for (auto at = parent_of.find(start); at != parent_of.end(); at = parent_of.find(at->second))
        if (!seen.insert(at->second).second)
          refuse("the joints go in a circle over link '" + file::shown(at->second) + "'", path_,
                 "remove the joint that closes the loop");
    }
  }

  // Throws Error(refused) if a link has a collision that urdfdom does not read, since it leaves
  // that out and reads on: the link would be smaller than it is, or be no obstacle at all.
  void check_collisions(const XmlFile& file, const urdf::ModelInterface& model) const {
    for (const TiXmlElement* element : file.children("link")) {
      const urdf::LinkConstSharedPtr link = model.getLink(attribute(*element, "name"));
      std::size_t written = 0;
      for (const TiXmlElement* one = element->FirstChildElement("collision"); one != nullptr;
           one = one->NextSiblingElement("collision")) {
        ++written;
        check_one_shape(*one, attribute(*element, "name"));
      }
      if (!link || link->collision_array.size() == written) continue;
      refuse("line " + std::to_string(element->Row()) + ": a <collision> of link '" +
                 file::shown(link->name) + "' cannot be read",
             path_,
             "its <geometry> is one box, cylinder, sphere or mesh, all of whose numbers are there, "
             "finite and with a decimal point; check_urdf (Debian: liburdfdom-tools) says more");
    }
  }

  // Throws Error(refused) if a collision has several shapes, of which urdfdom takes the first.
  void check_one_shape(const TiXmlElement& collision, const std::string& link) const {
    std::size_t shapes = 0;
    for (const TiXmlElement* geometry = collision.FirstChildElement("geometry");
         geometry != nullptr; geometry = geometry->NextSiblingElement("geometry"))
      for (const TiXmlElement* shape = geometry->FirstChildElement(); shape != nullptr;
           shape = shape->NextSiblingElement())
        ++shapes;
    if (shapes < 2) return;
    refuse("line " + std::to_string(collision.Row()) + ": a <collision> of link '" +
               file::shown(link) + "' has several shapes",
           path_, "give each a <collision> of its own");
  }

  // Adds the link, and after it all that its joints lead to.
  void add_link(const urdf::Link& link) {
    const std::size_t number = robot_.links.size();
    robot_.links.push_back({link.name, {}});
    for (const auto& collision : link.collision_array)
      robot_.links[number].shapes.push_back(shape_of(link.name, *collision));
    if (link.collision_array.empty() && !link.visual_array.empty())
      robot_.remarks.push_back(
          {true, "link '" + file::shown(link.name) +
                     "' is seen but has no collision geometry, and is left out: give it a "
                     "<collision> with the geometry of its <visual>"});
    for (const auto& joint : link.child_joints) {
      const std::size_t child = robot_.links.size();
      add_joint(number, child, *joint);
      const auto next = std::ranges::find(link.child_links, joint->child_link_name,
                                          [](const auto& one) { return one->name; });
      add_link(**next);
    }
  }

  void add_joint(std::size_t parent, std::size_t child, const urdf::Joint& from) {
    RobotJoint joint;
    joint.name = from.name;
    joint.parent = parent, joint.child = child;
    joint.origin = pose_of(from.parent_to_joint_origin_transform, "joint '" + from.name + "'");
    switch (from.type) {
      case urdf::Joint::FIXED:
        break;
      case urdf::Joint::REVOLUTE:
        joint.kind = RobotJoint::Kind::revolute;
        break;
      case urdf::Joint::CONTINUOUS:
        joint.kind = RobotJoint::Kind::continuous;
        break;
      case urdf::Joint::PRISMATIC:
        joint.kind = RobotJoint::Kind::prismatic;
        break;
      default:
        refuse(
            "joint '" + file::shown(from.name) + "' is planar or floating, and has no single value",
            path_, "make it fixed, or a chain of prismatic and revolute joints");
    }
    if (joint.kind != RobotJoint::Kind::fixed) {
      joint.axis = normalized_or_zero({from.axis.x, from.axis.y, from.axis.z});
      if (squared_norm(joint.axis) == 0)
        refuse("joint '" + file::shown(from.name) + "' has an axis without a direction", path_,
               "write <axis xyz=\"0 0 1\"/>");
    }
    const bool has_limits =
        joint.kind == RobotJoint::Kind::revolute || joint.kind == RobotJoint::Kind::prismatic;
    if (has_limits && from.limits)
      joint.lower = from.limits->lower, joint.upper = from.limits->upper;
    if (from.mimic) {
      leaders_[robot_.joints.size()] = from.mimic->joint_name;
      joint.multiplier = from.mimic->multiplier, joint.offset = from.mimic->offset;
    }
    robot_.joints.push_back(joint);
  }

  Pose pose_of(const urdf::Pose& from, const std::string& what) const {
    const auto& [position, q] = from;
    if (!is_finite(Vec3{position.x, position.y, position.z}))
      refuse("the origin of " + file::shown(what) + " is not finite", path_, "write numbers");
    return {rotation_from_quaternion({q.x, q.y, q.z, q.w}), {position.x, position.y, position.z}};
  }

  CollisionShape shape_of(const std::string& link, const urdf::Collision& collision) {
    const std::string what = "link '" + file::shown(link) + "'";
    CollisionShape shape;
    shape.to_link = pose_of(collision.origin, what);
    const urdf::Geometry& geometry = *collision.geometry;
    using Kind = CollisionShape::Kind;
    switch (geometry.type) {
      case urdf::Geometry::BOX: {
        const urdf::Vector3& dim = static_cast<const urdf::Box&>(geometry).dim;
        shape.kind = Kind::box, shape.size = {dim.x, dim.y, dim.z};
        check_size(what, {dim.x, dim.y, dim.z});
        break;
      }
      case urdf::Geometry::CYLINDER: {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        shape.kind = Kind::cylinder, shape.size = {cylinder.radius, 0, cylinder.length};
        check_size(what, {cylinder.radius, cylinder.radius, cylinder.length});
        break;
      }
      case urdf::Geometry::SPHERE: {
        const double radius = static_cast<const urdf::Sphere&>(geometry).radius;
        shape.kind = Kind::sphere, shape.size = {radius, 0, 0};
        check_size(what, {radius, radius, radius});
        break;
      }
      case urdf::Geometry::MESH: {
        const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
        shape.kind = Kind::mesh, shape.size = {mesh.scale.x, mesh.scale.y, mesh.scale.z};
        shape.mesh = mesh_path(what, mesh.filename);
        check_scale(what, shape.size);
        break;
      }
    }
    return shape;
  }

  void check_size(const std::string& what, Vec3 size) const {
    if (is_finite(size) && std::min({size.x, size.y, size.z}) > 0) return;
    refuse("a size of " + what + " is not positive", path_, "sizes are metres above 0");
  }

  void check_scale(const std::string& what, Vec3 scale) {
    if (!is_finite(scale) || scale.x * scale.y * scale.z == 0)
      refuse("the scale of a mesh of " + what + " is 0, or not finite", path_,
             "write scale=\"1 1 1\", or \"0.001 0.001 0.001\" for millimetres");
    if (std::min({scale.x, scale.y, scale.z}) < 0)
      robot_.remarks.push_back(
          {false, "a mesh of " + what +
                      " has a negative scale, and is mirrored; if that is not meant, write it "
                      "without the sign"});
  }

  // Returns the path of a mesh as the URDF names it.
  std::string mesh_path(const std::string& what, const std::string& name) const {
    constexpr std::string_view kPackage = "package://", kFile = "file://";
    const fs::path folder = fs::path(path_ == "-" ? "." : path_).parent_path();
    fs::path found;
    if (name.starts_with(kPackage)) {
      found = in_package(what, name.substr(kPackage.size()));
    } else if (name.find("://") != name.npos && !name.starts_with(kFile)) {
      refuse("the mesh " + file::shown(name) + " of " + what + " is not on this machine", path_,
             "fetch it, and write its path or package://PACKAGE/PATH");
    } else {
      found = name.starts_with(kFile) ? fs::path(name.substr(kFile.size())) : folder / name;
    }
    std::error_code fault;
    if (!fs::is_regular_file(found, fault))
      refuse("there is no mesh " + file::shown(found.string()) + ", which " + what + " names",
             path_,
             "paths in a URDF go from its folder, or from a package: package://PACKAGE/PATH");
    return found.string();
  }

  // Returns the file of a package: NAME/PATH.
  fs::path in_package(const std::string& what, const std::string& name) const {
    const fs::path rest(name), package = *rest.begin();
    fs::path inside;
    for (auto part = std::next(rest.begin()); part != rest.end(); ++part) inside /= *part;
    std::error_code fault;
    const auto is_folder = [&](const fs::path& one) { return fs::is_directory(one, fault); };
    for (const std::string& given : options_.package_path) {
      const fs::path folder = fs::absolute(given).lexically_normal();
      if (is_folder(folder / package)) return folder / package / inside;
      const fs::path last =
          folder.has_filename() ? folder.filename() : folder.parent_path().filename();
      if (last == package) return folder / inside;
    }
    for (fs::path folder = fs::absolute(path_).parent_path();; folder = folder.parent_path()) {
      if (folder.filename() == package) return folder / inside;
      if (is_folder(folder / package)) return folder / package / inside;
      if (folder == folder.parent_path()) break;
    }
    refuse("package '" + file::shown(package.string()) + "', of which " + what +
               " has a mesh, is not "
               "found",
           path_,
           "give `package_path` the folder that holds the folder " + file::shown(package.string()));
  }

  // Sets which joints have values of their own, in the order of the file; urdfdom's is alphabetic.
  void list_movable(const XmlFile& file) {
    for (const TiXmlElement* element : file.children("joint")) {
      const std::string name = attribute(*element, "name");
      for (std::size_t k = 0; k < robot_.joints.size(); ++k)
        if (robot_.joints[k].name == name && robot_.joints[k].kind != RobotJoint::Kind::fixed &&
            !leaders_.contains(k))
          robot_.movable.push_back(k);
    }
  }

  void resolve_mimics() {
    for (const auto& [follower, name] : leaders_) {
      const auto leader = std::ranges::find(robot_.joints, name, &RobotJoint::name);
      if (leader == robot_.joints.end())
        refuse("joint '" + file::shown(robot_.joints[follower].name) + "' mimics '" +
                   file::shown(name) + "', which is no joint",
               path_, "correct the name in <mimic>");
      robot_.joints[follower].mimics = static_cast<std::size_t>(leader - robot_.joints.begin());
    }
    for (const auto& [follower, name] : leaders_) {
      std::size_t steps = 0, at = follower;
      for (; robot_.joints[at].mimics && steps <= leaders_.size(); ++steps)
        at = *robot_.joints[at].mimics;
      if (steps > leaders_.size())
        refuse(
            "joint '" + file::shown(robot_.joints[follower].name) + "' mimics itself over others",
            path_, "let one of them have a value of its own");
    }
  }

  void check_shapes() const {
    const auto has_shapes = [](const RobotLink& link) { return !link.shapes.empty(); };
    if (!std::ranges::any_of(robot_.links, has_shapes))
      refuse("no link has collision geometry", path_,
             "give links a <collision> with the geometry of their <visual>");
  }

  const std::string& path_;
  const RobotOptions& options_;
  Robot robot_;
  std::map<std::size_t, std::string> leaders_;  // names of the joints that joints mimic
};

}  // namespace

Robot read_robot(const std::string& path, const RobotOptions& options) {
  return Reader(path, options).read();
}

}  // namespace vpm
