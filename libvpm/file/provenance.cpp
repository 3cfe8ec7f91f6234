#include "libvpm/file/provenance.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace vpm::file {

Provenance::Provenance() = default;
Provenance::Provenance(nlohmann::json content)
    : content_(std::make_unique<nlohmann::json>(std::move(content))) {}
Provenance::Provenance(const Provenance& other)
    : content_(other.content_ ? std::make_unique<nlohmann::json>(*other.content_) : nullptr) {}
Provenance::Provenance(Provenance&& other) noexcept = default;
Provenance& Provenance::operator=(const Provenance& other) {
  *this = Provenance(other);
  return *this;
}
Provenance& Provenance::operator=(Provenance&& other) noexcept = default;
Provenance::~Provenance() = default;

const nlohmann::json& Provenance::json() const {
  static const nlohmann::json null;
  return content_ ? *content_ : null;
}

nlohmann::json& Provenance::json() {
  if (!content_) content_ = std::make_unique<nlohmann::json>();
  return *content_;
}

}  // namespace vpm::file
