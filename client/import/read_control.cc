// <Module> and <Control> [FEBio User Manual, 3.2 and 3.3].
#include <algorithm>
#include <cmath>
#include <string_view>

#include "client/import/sections.h"
#include "core/base/letters.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {

void ReadModule(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  const std::string type = source.Required(section, "type");
  if (!type.empty() && type != "solid" && type != "explicit-solid") {
    source.Fail(section, "the module " + Quoted(type) + " is not supported", "fascicle supports solids only");
  }
  const pugi::xml_node units = section.child("units");
  if (!units) return;
  const std::string name = source.Text(units);
  if (!model.units.name.empty()) return;  // already given by the user
  if (const auto system = UnitSystemNamed(name)) {
    model.units = *system;
  } else {
    source.Fail(units, "the units " + Quoted(name) + " are not known", "give --units: " + KnownUnitSystems());
  }
}

void ReadControl(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  Control& control = model.control;
  control.node = section;
  if (const pugi::xml_node analysis = section.child("analysis")) {
    // Version 3 may have the type as an attribute.
    std::string text = source.Text(analysis);
    if (text.empty()) text = analysis.attribute("type").value();
    text = Lower(text);
    control.dynamic = text == "dynamic" || text == "1";
    if (!control.dynamic && text != "static" && text != "0") {
      source.Fail(analysis, "the analysis " + Quoted(text) + " is not supported", "static and dynamic are supported");
    }
  }
  for (const auto& [name, value] :
       {std::pair("time_steps", &control.steps), std::pair("step_size", &control.step_size)}) {
    const pugi::xml_node child = section.child(name);
    if (!child) {
      source.Fail(section, "has no " + std::string(name), "give <" + std::string(name) + ">");
      continue;
    }
    const std::size_t before = source.failures();
    *value = source.Number(child);
    if (!(*value > 0) && source.failures() == before) source.Fail(child, "is not positive");
  }
  if (control.steps != std::floor(control.steps)) source.Fail(section.child("time_steps"), "is not a whole number");
  if (const pugi::xml_node stride = section.child("plot_stride")) {
    control.stride = std::max(1.0, std::floor(source.Number(stride)));
  }
  bool any_setting = false;
  for (const pugi::xml_node child : section.children()) {
    if (child.type() != pugi::node_element) continue;
    const std::string_view name = child.name();
    if (name == "analysis" || name == "time_steps" || name == "step_size" || name == "plot_stride") continue;
    source.TakeAll(child);
    any_setting = true;
  }
  if (any_setting) {
    source.Remark(Notice::Kind::kNote, section,
                  "solver, time stepper and output levels are replaced by fascicle's own");
  }
}

}  // namespace fascicle::client
