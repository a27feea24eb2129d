#ifndef FASCICLE_SERVER_TRANSLATE_MATERIALS_H_
#define FASCICLE_SERVER_TRANSLATE_MATERIALS_H_

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/materials/material.h"
#include "core/scene/scene.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

// The law of a material message; null if it has none.
const LawInfo* LawOf(const v1::Material& material);

// The values of the law's parameters in their order, defaults filled in. The message must have a law and obey the
// rules.
std::vector<double> ParametersOf(const v1::Material& material);

// Makes the law of a material message from other values of its parameters; what is not a number is that of the message.
// The message must have a law and obey the rules. Problems of a law's curves are reported at `path`, that of the
// message.
std::function<Material(std::span<const double>)> MakerOf(const v1::Material& material, const std::string& path,
                                                         Problems& problems);

// The material of a body or of a part of it; `material` is null, which is a problem, if there is none. A soft isotropic
// material replaces an invalid one in later checks.
Material TranslateMaterial(const v1::Material* material, const std::string& owner_path, Problems& problems);

// The Prony series of a material of a body or of a part of it; empty if it is elastic or invalid.
//   path  of the material
PronySeries TranslateViscoelasticity(const v1::Material& material, const std::string& path, Problems& problems);

Damping TranslateDamping(const v1::Body& body);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_MATERIALS_H_
