#ifndef FASCICLE_SERVER_TRANSLATE_MATERIALS_H_
#define FASCICLE_SERVER_TRANSLATE_MATERIALS_H_

#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/materials/material.h"
#include "core/scene/scene.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

// The law that a material message names; nullptr when it names none.
const LawInfo* LawOf(const v1::Material& material);

// The values of its law's parameters in their order, defaults filled in; it names a law and obeys the rules.
std::vector<double> ParametersOf(const v1::Material& material);

// The material that a body or a part of it has; nullptr, a problem, where there is none. A soft isotropic one stands
// for a wrong one in later checks.
Material TranslateMaterial(const v1::Material* material, const std::string& owner_path, Problems& problems);

Damping TranslateDamping(const v1::Body& body);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_MATERIALS_H_
