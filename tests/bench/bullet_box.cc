#include "bullet_box.h"

#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBody.h>

namespace fascicle::bench {
namespace {

btVector3 ToBullet(const Vec3& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

}  // namespace

struct BulletBox::Impl {
  btSoftBodyWorldInfo world;
  std::unique_ptr<btSoftBody> body;
  btDeformableNeoHookeanForce law;
  btAlignedObjectArray<btVector3> forces;
};

BulletBox::BulletBox(const TetMesh& mesh, double mu, double lambda) : impl_(std::make_unique<Impl>()) {
  Impl& b = *impl_;
  btAlignedObjectArray<btVector3> nodes;
  btAlignedObjectArray<btScalar> masses;
  for (const Vec3& X : mesh.nodes) {
    nodes.push_back(ToBullet(X));
    masses.push_back(1);
  }
  b.body = std::make_unique<btSoftBody>(&b.world, nodes.size(), &nodes[0], &masses[0]);
  for (const Tetrahedron& tet : mesh.tetrahedra) b.body->appendTetra(tet[0], tet[1], tet[2], tet[3]);
  for (int n = 0; n < b.body->m_nodes.size(); ++n) b.body->m_nodes[n].index = n;
  b.body->initializeDmInverse();
  b.body->m_tetraScratches.resize(b.body->m_tetras.size());
  b.body->m_tetraScratchesTn.resize(b.body->m_tetras.size());
  b.law.setLameParameters(static_cast<btScalar>(mu), static_cast<btScalar>(lambda));
  b.law.setDamping(0);
  b.law.addSoftBody(b.body.get());
  b.forces.resize(nodes.size());
}

BulletBox::~BulletBox() = default;

void BulletBox::SetPositions(const NodalVector& x) {
  for (std::size_t n = 0; n < x.size(); ++n) {
    btSoftBody::Node& node = impl_->body->m_nodes[static_cast<int>(n)];
    node.m_x = node.m_q = ToBullet(x[n]);
  }
}

void BulletBox::Evaluate() {
  Impl& b = *impl_;
  b.body->updateDeformation();
  for (int n = 0; n < b.forces.size(); ++n) b.forces[n].setZero();
  b.law.addScaledForces(1, b.forces);
}

NodalVector BulletBox::Forces() const {
  NodalVector forces;
  for (int n = 0; n < impl_->forces.size(); ++n) {
    const btVector3& f = impl_->forces[n];
    forces.emplace_back(f[0], f[1], f[2]);
  }
  return forces;
}

}  // namespace fascicle::bench
