#include "core/sim/run_warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>

namespace fascicle {
namespace {

// A law whose bulk modulus is this many times its shear modulus (Poisson's ratio 0.45) is meant to keep its volume.
constexpr double kNearlyIncompressible = 10;
constexpr double kLeastVolumeRatio = 0.9, kLargestVolumeRatio = 1.1;
// Force-length curves and passive stresses are measured within these stretches of a fibre.
constexpr double kLeastStretch = 0.5, kLargestStretch = 1.6;
// Linear elasticity.
constexpr double kLargestStrain = 0.1;
// Missing or surplus energy, relative to the energy that was exchanged.
constexpr double kEnergyGap = 0.02;
// Logarithmic strain of a step without inertia: beyond a third of the length, another equilibrium may be nearer.
constexpr double kLargestStepStrain = 0.4;

bool KeepsVolume(const Material& material) {
  return std::visit([](const auto& law) { return law.BulkModulus() >= kNearlyIncompressible * law.ShearModulus(); },
                    material);
}

bool IsLinear(const Material& material) { return std::holds_alternative<LinearElastic>(material); }

bool NeedsFibres(const Material& material) {
  return std::visit([]<class Law>(const Law&) { return Law::kNeedsFibres; }, material);
}

template <class Holds>
bool AllMaterials(const Body& body, const Parts<Material>& parts, const Holds& holds) {
  return holds(body.material) && std::all_of(parts.more.begin(), parts.more.end(), holds);
}

bool IsActivated(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const Body& body) { return NeedsFibres(body.material); });
}

template <class... Values>
std::string Format(const char* format, Values... values) {
  std::array<char, 400> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string ElementText(std::int64_t element) { return element < 0 ? "it" : "element " + std::to_string(element); }

}  // namespace

RunWarnings::RunWarnings(const Scene& scene, const std::vector<SeriesInfo>& series) : scene_(&scene) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (const auto* tet = std::get_if<TetShape>(&body.shape)) {
      if (IsLinear(body.material)) watches_.push_back({b, Quantity::kStrain, {}, {}});
      if (AllMaterials(body, tet->materials, KeepsVolume)) watches_.push_back({b, Quantity::kVolumeRatio, {}, {}});
      if (!tet->fibres.empty() && NeedsFibres(body.material)) watches_.push_back({b, Quantity::kFibreStretch, {}, {}});
    } else if (std::holds_alternative<VoxelShape>(body.shape)) {
      watches_.push_back({b, Quantity::kStrain, {}, {}});
    }
  }
  constexpr std::string_view kContact = "contact/", kDepth = "/relative_depth";
  for (std::size_t k = 0; k < series.size(); ++k) {
    const std::string& name = series[k].name;
    if (!name.starts_with(kContact) || !name.ends_with(kDepth)) continue;
    contacts_.push_back({name.substr(kContact.size(), name.size() - kContact.size() - kDepth.size()), k, {}});
  }
  // Work of activation is known in quasi-static runs only, which integrate it along each step.
  if (scene.method != Method::kTet || scene.tet.stepping == Stepping::kQuasiStatic || IsActivated(scene)) return;
  for (const auto& [name, sign] :
       {std::pair("energy/elastic", 1.0), std::pair("energy/kinetic", 1.0), std::pair("energy/contact", 1.0),
        std::pair("energy/dissipated", 1.0), std::pair("energy/external_work", -1.0)}) {
    for (std::size_t k = 0; k < series.size(); ++k) {
      if (series[k].name == name) balance_.push_back({k, sign});
    }
  }
}

void RunWarnings::ObserveFrame(const Frame& frame, const MethodRun& method, const Controls& now,
                               const Controls& later) {
  for (Watch& watch : watches_) {
    switch (watch.quantity) {
      case Quantity::kVolumeRatio:
        ObserveElements(watch, method.ElementValues(watch.body, OutputField::kVolumeRatio, now, later), frame.time);
        break;
      case Quantity::kFibreStretch:
        ObserveElements(watch, method.ElementValues(watch.body, OutputField::kFibreStretch, now, later), frame.time);
        break;
      case Quantity::kStrain: {
        const std::vector<double> all = method.ElementValues(watch.body, OutputField::kPrincipalStrains, now, later);
        std::vector<double> largest(all.size() / 3);
        for (std::size_t e = 0; e < largest.size(); ++e) {
          for (int k = 0; k < 3; ++k) largest[e] = std::max(largest[e], std::abs(all[3 * e + k]));
        }
        ObserveElements(watch, largest, frame.time);
        break;
      }
    }
  }
  ObserveContact(frame);
  ObserveEnergy(frame);
}

void RunWarnings::ObserveContact(const Frame& frame) {
  for (ContactWatch& contact : contacts_) {
    const double depth = frame.series[contact.column];
    if (!contact.deepest.seen || depth > contact.deepest.value) contact.deepest = {depth, frame.time, -1, true};
  }
}

void RunWarnings::ObserveElements(Watch& watch, const std::vector<double>& values, double time) {
  if (values.empty()) return;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (!watch.lowest.seen || *low < watch.lowest.value) watch.lowest = {*low, time, low - values.begin(), true};
  if (!watch.highest.seen || *high > watch.highest.value) watch.highest = {*high, time, high - values.begin(), true};
}

void RunWarnings::ObserveEnergy(const Frame& frame) {
  if (balance_.empty()) return;
  double energy = 0, size = 0;
  for (const Term& term : balance_) {
    energy += term.sign * frame.series[term.column];
    size = std::max(size, std::abs(frame.series[term.column]));
  }
  if (!has_start_) {
    energy_at_start_ = energy;
    has_start_ = true;
  }
  exchanged_ = std::max(exchanged_, size);
  if (std::abs(energy - energy_at_start_) <= std::abs(gap_)) return;
  gap_ = energy - energy_at_start_;
  gap_time_ = frame.time;
}

void RunWarnings::ObserveStep(const StepOutcome& step, double time) {
  if (step.largest_strain <= step_.value) return;
  step_ = {step.largest_strain, time, step.strained_element, true};
  step_body_ = step.strained_body;
}

void RunWarnings::AddRange(const Watch& watch, std::vector<Warning>& warnings) const {
  const std::string& name = scene_->bodies[watch.body].name;
  const auto add = [&](const char* reason, const Extreme& at, std::string message, const char* advice) {
    warnings.push_back({reason, std::move(message), advice, at.time, name, {}});
    if (at.element >= 0) warnings.back().elements.push_back(at.element);
  };
  const Extreme &low = watch.lowest, &high = watch.highest;
  switch (watch.quantity) {
    case Quantity::kVolumeRatio: {
      constexpr const char* kAdvice =
          "use a larger bulk modulus or a finer mesh there, or look for a support, a load or fibres that tear at it";
      if (low.seen && low.value < kLeastVolumeRatio) {
        add("VOLUME_RATIO", low,
            Format("%s shrinks to %.2f of its volume, although its law is nearly incompressible",
                   ElementText(low.element).c_str(), low.value),
            kAdvice);
      }
      if (high.seen && high.value > kLargestVolumeRatio) {
        add("VOLUME_RATIO", high,
            Format("%s grows to %.2f of its volume, although its law is nearly incompressible",
                   ElementText(high.element).c_str(), high.value),
            kAdvice);
      }
      return;
    }
    case Quantity::kFibreStretch: {
      constexpr const char* kAdvice =
          "muscle is not measured there: look at fibre_stretch near it; give ends a tendon, or supports less motion";
      if (low.seen && low.value < kLeastStretch) {
        add("FIBRE_STRETCH", low,
            Format("fibres of %s shorten to a stretch of %.2f", ElementText(low.element).c_str(), low.value), kAdvice);
      }
      if (high.seen && high.value > kLargestStretch) {
        add("FIBRE_STRETCH", high,
            Format("fibres of %s lengthen to a stretch of %.2f", ElementText(high.element).c_str(), high.value),
            kAdvice);
      }
      return;
    }
    case Quantity::kStrain:
      if (high.seen && high.value > kLargestStrain) {
        add("STRAIN", high,
            Format("strains reach %.0f %% in %s, but the law is linear", 100 * high.value,
                   ElementText(high.element).c_str()),
            "trust directions more than sizes, or simulate it by the tet method with a law for large strains");
      }
      return;
  }
}

std::optional<Warning> RunWarnings::EnergyWarning() const {
  if (!(std::abs(gap_) > kEnergyGap * exchanged_)) return std::nullopt;
  return Warning{"ENERGY",
                 Format("the energies differ from the work by %.3g J, %.1f %% of what was exchanged", gap_,
                        100 * gap_ / exchanged_),
                 "use a smaller time_step or safety, or another stepping",
                 gap_time_,
                 {},
                 {}};
}

std::optional<Warning> RunWarnings::StepWarning() const {
  if (!(step_.value > kLargestStepStrain)) return std::nullopt;
  Warning warning{"LARGE_STEP",
                  Format("a single step changes lengths by a factor of %.2f, as in %s", std::exp(step_.value),
                         ElementText(step_.element).c_str()),
                  "the equilibrium found may differ from that of a slower motion: repeat with a smaller time_step",
                  step_.time,
                  scene_->bodies[step_body_].name,
                  {}};
  if (step_.element >= 0) warning.elements.push_back(step_.element);
  return warning;
}

std::vector<Warning> RunWarnings::List() const {
  std::vector<Warning> warnings;
  for (const Watch& watch : watches_) AddRange(watch, warnings);
  for (const ContactWatch& contact : contacts_) {
    if (!(contact.deepest.value > 1)) continue;
    warnings.push_back({"CONTACT_DEPTH",
                        Format("bodies penetrate by %.2f times a tenth of an element's edge in the contact %s",
                               contact.deepest.value, contact.name.c_str()),
                        "use a finer mesh there, a smaller time_step, or load and move more slowly",
                        contact.deepest.time,
                        {},
                        {}});
  }
  if (std::optional<Warning> energy = EnergyWarning()) warnings.push_back(*std::move(energy));
  if (std::optional<Warning> step = StepWarning()) warnings.push_back(*std::move(step));
  return warnings;
}

// Calls visit(number) for every number of the state.
template <class Self, class Visit>
void RunWarnings::VisitNumbers(Self& self, const Visit& visit) {
  const auto visit_extreme = [&](auto& extreme) {
    visit(extreme.value);
    visit(extreme.time);
    visit(extreme.element);
    visit(extreme.seen);
  };
  for (auto& watch : self.watches_) {
    visit_extreme(watch.lowest);
    visit_extreme(watch.highest);
  }
  for (auto& contact : self.contacts_) visit_extreme(contact.deepest);
  visit(self.energy_at_start_);
  visit(self.gap_);
  visit(self.gap_time_);
  visit(self.exchanged_);
  visit(self.has_start_);
  visit_extreme(self.step_);
  visit(self.step_body_);
}

void RunWarnings::Save(ArchiveWriter& archive) const {
  std::vector<double> numbers;
  VisitNumbers(*this, [&](const auto& number) { numbers.push_back(static_cast<double>(number)); });
  archive.PutDoubles("warnings", numbers);
}

void RunWarnings::Load(ArchiveReader& archive) {
  std::size_t count = 0;
  VisitNumbers(*this, [&](const auto&) { ++count; });
  std::vector<double> numbers(count);
  archive.GetDoubles("warnings", std::span<double>(numbers));
  std::size_t k = 0;
  VisitNumbers(*this, [&]<class Number>(Number& number) { number = static_cast<Number>(numbers[k++]); });
  if (step_body_ >= scene_->bodies.size()) step_body_ = 0;
}

}  // namespace fascicle
