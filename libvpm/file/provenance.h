// Provenance: who made a file, of what and with which options, as JSON.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>

namespace vpm::file {

// Holds JSON out of line: structs with a provenance are in most headers, and each source that
// copies JSON compiles two seconds longer. Whoever reads or sets what it holds includes
// nlohmann/json.hpp.
class Provenance {
 public:
  Provenance();                        // holds null: nothing is known
  Provenance(nlohmann::json content);  // NOLINT(google-explicit-constructor): assigned as JSON
  Provenance(const Provenance& other);
  Provenance(Provenance&& other) noexcept;
  Provenance& operator=(const Provenance& other);
  Provenance& operator=(Provenance&& other) noexcept;
  ~Provenance();

  // Returns the content: null if nothing was set or it was moved away.
  const nlohmann::json& json() const;
  nlohmann::json& json();

 private:
  std::unique_ptr<nlohmann::json> content_;  // or nullptr for null
};

}  // namespace vpm::file
