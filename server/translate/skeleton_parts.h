#ifndef FASCICLE_SERVER_TRANSLATE_SKELETON_PARTS_H_
#define FASCICLE_SERVER_TRANSLATE_SKELETON_PARTS_H_

#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "core/skeleton/skeleton_mechanics.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/names.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// Parts of the translation of a skeleton, whose message obeys the rules. Paths of problems begin with `skeleton`.

// The names of its lists, for references.
struct SkeletonNames {
  Names bones{"bone"}, coordinates{"coordinate"}, surfaces{"wrap surface"}, muscles{"muscle of the skeleton"};

  // A bone, or the ground (-1) for an empty name and after a problem.
  int BoneOrGround(const std::string& name, const std::string& path, Problems& problems) const;
  // A coordinate; -1 after a problem.
  int Coordinate(const std::string& name, const std::string& path, Problems& problems) const;
};

// Bones but their shapes, coordinates and joints.
void TranslateBones(const v1::Skeleton& wire, Skeleton& skeleton, Problems& problems);
void TranslateJoints(const v1::Skeleton& wire, const SkeletonNames& names, Skeleton& skeleton, Problems& problems);
// The shapes of all bones, of a million triangles at most. Remarks on files are added to `notes`.
std::vector<TriangleMesh> TranslateBoneShapes(const v1::Skeleton& wire, const AssetReader& assets,
                                              const TranslateTools& tools, std::vector<std::string>& notes,
                                              Problems& problems);
// Wrap surfaces and muscles.
void TranslateLineMuscles(const v1::Skeleton& wire, const SkeletonNames& names, Skeleton& skeleton, Problems& problems);

// How the coordinates change, and the activations, for a complete skeleton.
SkeletonMotion TranslateSkeletonMotion(const v1::Skeleton& wire, const Skeleton& skeleton, const SkeletonNames& names,
                                       const AssetReader& assets, std::vector<std::string>& notes, Problems& problems);
std::vector<Curve> TranslateMuscleDrive(const v1::Scene& scene, SkeletonMechanics& mechanics,
                                        const SkeletonMotion& motion, MuscleStrength strength,
                                        const SkeletonNames& names, const AssetReader& assets,
                                        const TranslateTools& tools, std::vector<std::string>& notes,
                                        Problems& problems);

Pose ToPose(const v1::Placement& placement);
// A problem with more than `most` entries.
void CheckCount(int size, int most, const std::string& path, Problems& problems);
// A polynomial, or a curve through points.
ScalarFunction TranslateFunction(const v1::CoordinateFunction& wire, const std::string& path, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_SKELETON_PARTS_H_
