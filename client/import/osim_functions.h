#ifndef FASCICLE_CLIENT_IMPORT_OSIM_FUNCTIONS_H_
#define FASCICLE_CLIENT_IMPORT_OSIM_FUNCTIONS_H_

#include <optional>
#include <pugixml.hpp>
#include <vector>

#include "client/import/xml_source.h"
#include "core/skeleton/scalar_function.h"

namespace fascicle::client {

// The finite numbers of an element, any number of them; empty, with a problem, if one is not.
std::vector<double> NumbersOf(XmlSource& xml, pugi::xml_node node);

// The function of an element of an OpenSim model: its child, or that of its child <function>. Nothing, with a problem,
// if its kind is not supported or its values are wrong; nothing, without one, if there is none.
std::optional<ScalarFunction> ReadFunction(XmlSource& xml, pugi::xml_node parent);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_OSIM_FUNCTIONS_H_
