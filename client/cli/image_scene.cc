#include "client/cli/image_scene.h"

#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "client/lib/replace_file.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

// A length or a place in mm, to a hundredth.
double Millimetres(double metres) { return std::round(metres * 1e5) / 100; }
Json MillimetresJson(const Vec3& place) {
  return {Millimetres(place[0]), Millimetres(place[1]), Millimetres(place[2])};
}

}  // namespace

VoxelPlace PlaceOf(const VoxelGrid& grid) {
  VoxelPlace place;
  place.low.setConstant(INFINITY);
  place.high.setConstant(-INFINITY);
  const Vec3 half = grid.direction.cwiseAbs() * grid.spacing / 2;  // of a voxel's box
  Vec3 sum = Vec3::Zero();
  double count = 0;
  std::size_t v = 0;
  for (std::int32_t k = 0; k < grid.size[2]; ++k) {
    for (std::int32_t j = 0; j < grid.size[1]; ++j) {
      for (std::int32_t i = 0; i < grid.size[0]; ++i) {
        if (grid.material[v++] == 0) continue;
        const Vec3 centre = grid.origin + grid.direction * grid.spacing.cwiseProduct(Vec3(i + 0.5, j + 0.5, k + 0.5));
        place.low = place.low.cwiseMin(centre - half);
        place.high = place.high.cwiseMax(centre + half);
        sum += Vec3(i, j, k);
        ++count;
      }
    }
  }
  const Vec3 middle = sum / count;
  place.middle = grid.origin + grid.direction * grid.spacing.cwiseProduct(middle + Vec3::Constant(0.5));
  for (int d = 0; d < 3; ++d)
    place.middle_voxel[static_cast<std::size_t>(d)] = static_cast<int>(std::lround(middle[d]));
  return place;
}

void PrintPlace(const VoxelPlace& place) {
  const auto mm = [](double metres) { return Millimetres(metres); };
  std::printf("box       x %.6g to %.6g, y %.6g to %.6g, z %.6g to %.6g mm (x left, y back, z head)\n",
              mm(place.low[0]), mm(place.high[0]), mm(place.low[1]), mm(place.high[1]), mm(place.low[2]),
              mm(place.high[2]));
  std::printf("middle    %.6g, %.6g, %.6g mm; voxel %d,%d,%d\n", mm(place.middle[0]), mm(place.middle[1]),
              mm(place.middle[2]), place.middle_voxel[0], place.middle_voxel[1], place.middle_voxel[2]);
}

Json PlaceJson(const VoxelPlace& place) {
  const auto list = [](const Vec3& x) { return Json::array({x[0], x[1], x[2]}); };
  return {{"box", {{"min", list(place.low)}, {"max", list(place.high)}}},
          {"middle", list(place.middle)},
          {"middle_voxel", place.middle_voxel}};
}

void WriteImageScene(const fs::path& scene, const fs::path& labels, const VoxelPlace& place, int label_count,
                     int level) {
  constexpr double kEnd = 0.15;  // of the length, supported and loaded
  Eigen::Index along = 0;
  const double length = (place.high - place.low).maxCoeff(&along);
  const Vec3 axis = Vec3::Unit(along);
  Vec3 low = place.middle, high = place.middle;
  low[along] = place.low[along] + kEnd * length;
  high[along] = place.high[along] - kEnd * length;
  Json values = Json::array();
  for (int label = 1; label <= label_count; ++label) values.push_back(label);
  const auto plane = [](const char* name, const Vec3& point, const Vec3& normal) {
    return Json{
        {"name", name},
        {"plane", {{"point", MillimetresJson(point)}, {"normal", Json::array({normal[0], normal[1], normal[2]})}}}};
  };
  const Vec3 force = 10 * axis;
  const fs::path folder = fs::absolute(scene).parent_path();
  Json image = {{"file", {{"path", fs::absolute(labels).lexically_relative(folder).string()}}},
                {"labels", {{"values", std::move(values)}}},
                {"cleaning", {{"keep", "all"}, {"leave_holes", true}}},
                {"level", level}};
  Json body = {{"name", "body"},
               {"unit", "mm"},
               {"mesh", {{"image", std::move(image)}}},
               {"material", {{"linear_elastic", {{"young_modulus", 1e6}, {"poisson_ratio", 0.4}}}}},
               {"regions", Json::array({plane("lower", low, -axis), plane("upper", high, axis)})},
               {"constraints", Json::array({{{"region", "lower"}}})},
               {"loads", Json::array({{{"region", "upper"},
                                       {"nodal_force", {{"total", Json::array({force[0], force[1], force[2]})}}},
                                       {"scale", {{"times", {0, 2}}, {"values", {0, 1}}}}}})}};
  const Json probe = {{"name", "upper"}, {"body", "body"}, {"point", MillimetresJson(high)}};
  const Json text = {
      {"name", labels.stem().string()},
      {"bodies", Json::array({std::move(body)})},
      {"duration", 2},
      {"output", {{"frame_interval", 1}, {"fields", {"von_mises_stress"}}, {"probes", Json::array({probe})}}},
      {"voxel", {{"stepping", "static"}}}};
  ReplaceFile(scene, text.dump(2) + "\n");
}

}  // namespace fascicle::client
