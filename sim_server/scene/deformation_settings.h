#pragma once
#include <any>
#include <map>
#include <string>
#include <typeindex>

namespace palpate::sim {

/// `[deformation]`: which model, and what its row of `deformation_models()` read for it. A scene need not
/// know the settings of any model: each model has a struct of its own, known here by its type alone, whose
/// members begin at their defaults.
class DeformationSettings {
 public:
  std::string model;  ///< a name of `deformation_models()`
  std::string where;  ///< "FILE:LINE" of `model`

  /// The settings of type `Part`; made with its defaults where there are none yet.
  template <class Part>
  Part& of() {
    std::any& part = parts_[typeid(Part)];
    if (!part.has_value()) part.emplace<Part>();
    return *std::any_cast<Part>(&part);
  }
  /// Returns the settings of type `Part`; the defaults where there are none.
  template <class Part>
  const Part& of() const {
    static const Part defaults{};
    const auto* part = find<Part>();
    return part != nullptr ? *part : defaults;
  }
  /// Null where the model of the file takes no such settings.
  template <class Part>
  const Part* find() const {
    const auto found = parts_.find(typeid(Part));
    return found == parts_.end() ? nullptr : std::any_cast<Part>(&found->second);
  }

 private:
  std::map<std::type_index, std::any> parts_;
};

}  // namespace palpate::sim
