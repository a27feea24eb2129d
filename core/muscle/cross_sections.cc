#include "core/muscle/cross_sections.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>

namespace fascicle {
namespace {

struct Piece {
  double potential;
  double volume;  // [m^3]
  Vec3 centroid;  // [m]
};

// Groups of tetrahedra in the order of their potential, from the origin to the insertion.
std::vector<Piece> PiecesAlong(const TetMesh& mesh, const std::vector<double>& potential) {
  std::vector<Piece> pieces;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    Piece piece{0, SignedVolume(mesh, e), Centroid(mesh, e)};
    double lowest = 1, highest = 0;
    for (const std::int32_t node : mesh.tetrahedra[e]) {
      const double value = potential[static_cast<std::size_t>(node)];
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
      piece.potential += value / 4;
    }
    if (highest > lowest) pieces.push_back(piece);
  }
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const Piece& a, const Piece& b) { return a.potential < b.potential; });
  return pieces;
}

}  // namespace

std::optional<CrossSections> CrossSections::Make(const TetMesh& mesh, const std::vector<double>& potential) {
  CrossSections sections;
  sections.Cut(mesh, potential);
  if (sections.slices_.size() < 2) return std::nullopt;
  sections.Smooth();
  sections.LayFrames();
  return sections;
}

void CrossSections::Cut(const TetMesh& mesh, const std::vector<double>& potential) {
  constexpr std::size_t kPiecesEach = 60, kMost = 40;
  const std::vector<Piece> pieces = PiecesAlong(mesh, potential);
  const std::size_t count = std::clamp<std::size_t>(pieces.size() / kPiecesEach, 2, kMost);
  for (std::size_t s = 0; s < count; ++s) {
    const auto begin = pieces.begin() + static_cast<std::ptrdiff_t>(s * pieces.size() / count);
    const auto end = pieces.begin() + static_cast<std::ptrdiff_t>((s + 1) * pieces.size() / count);
    Slice slice{0, Vec3::Zero(), Mat3::Zero(), 0, {}};
    double volume = 0;
    for (auto piece = begin; piece != end; ++piece) {
      volume += piece->volume;
      slice.potential += piece->volume * piece->potential;
      slice.center += piece->volume * piece->centroid;
    }
    if (!(volume > 0)) continue;
    slice.potential /= volume;
    slice.center /= volume;
    for (auto piece = begin; piece != end; ++piece) {
      const Vec3 offset = piece->centroid - slice.center;
      slice.covariance += piece->volume / volume * offset * offset.transpose();
    }
    if (slices_.empty() || slice.potential > slices_.back().potential) slices_.push_back(slice);
  }
}

// Slices are slanted and ragged, so their centroids jump: averages three neighbours; the ends stay.
void CrossSections::Smooth() {
  constexpr int kPasses = 3;
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::vector<Slice> old = slices_;
    for (std::size_t s = 1; s + 1 < slices_.size(); ++s) {
      slices_[s].center = (old[s - 1].center + 2 * old[s].center + old[s + 1].center) / 4;
      slices_[s].covariance = (old[s - 1].covariance + 2 * old[s].covariance + old[s + 1].covariance) / 4;
    }
  }
}

void CrossSections::LayFrames() {
  Vec3 first = Vec3::Zero();
  for (std::size_t s = 0; s < slices_.size(); ++s) {
    Slice& slice = slices_[s];
    if (s > 0) slice.length = slices_[s - 1].length + (slice.center - slices_[s - 1].center).norm();
    const std::size_t before = s == 0 ? 0 : s - 1, after = std::min(s + 1, slices_.size() - 1);
    const Vec3 tangent = (slices_[after].center - slices_[before].center).stableNormalized();
    // The previous slice's axis, projected to be normal to the middle line: the axes do not twist about it.
    first = (first - first.dot(tangent) * tangent).stableNormalized();
    if (!(first.norm() > 0.5)) first = tangent.unitOrthogonal();
    Eigen::Matrix<double, 2, 3> axes;
    axes << first.transpose(), tangent.cross(first).transpose();
    const Eigen::Matrix2d spread = axes * slice.covariance * axes.transpose();
    slice.across = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).operatorInverseSqrt() * axes;
  }
}

CrossSections::Place CrossSections::Find(double potential) const {
  const auto after = std::upper_bound(slices_.begin() + 1, slices_.end() - 1, potential,
                                      [](double value, const Slice& slice) { return value < slice.potential; });
  const Slice &a = *(after - 1), &b = *after;
  return {static_cast<std::size_t>(after - slices_.begin()) - 1,
          (potential - a.potential) / (b.potential - a.potential)};
}

double CrossSections::Length(double potential) const {
  const auto [before, fraction] = Find(potential);
  return slices_[before].length + fraction * (slices_[before + 1].length - slices_[before].length);
}

double CrossSections::Along(double potential) const {
  return (Length(potential) - Length(0)) / (Length(1) - Length(0));
}

Eigen::Vector2d CrossSections::Across(const Vec3& X, double potential) const {
  const auto [before, beyond] = Find(potential);
  const Slice &a = slices_[before], &b = slices_[before + 1];
  // Beyond the outermost slices the middle line continues straight with unchanged frames.
  const double fraction = std::clamp(beyond, 0.0, 1.0);
  return ((1 - fraction) * a.across + fraction * b.across) * (X - a.center - beyond * (b.center - a.center));
}

}  // namespace fascicle
