#include "getfem_box.h"

#include <getfem/getfem_models.h>
#include <getfem/getfem_nonlinear_elasticity.h>

#include <vector>

namespace fascicle::bench {

struct GetfemBox::Impl {
  NodalVector ToNodes(const std::vector<double>& components) const {
    NodalVector nodes(first_component.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      for (int c = 0; c < 3; ++c) nodes[n][c] = components[first_component[n] + c];
    }
    return nodes;
  }
  std::vector<double> ToComponents(const NodalVector& nodes) const {
    std::vector<double> components(3 * nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      for (int c = 0; c < 3; ++c) components[first_component[n] + c] = nodes[n][c];
    }
    return components;
  }

  NodalVector rest;
  getfem::mesh mesh;
  std::unique_ptr<getfem::mesh_fem> displacement;
  std::unique_ptr<getfem::mesh_im> integration;
  getfem::model model;
  std::vector<std::size_t> first_component;  // of each node
};

GetfemBox::GetfemBox(const TetMesh& mesh, double mu, double lambda) : impl_(std::make_unique<Impl>()) {
  gmm::set_traces_level(0);
  Impl& g = *impl_;
  g.rest = mesh.nodes;
  std::vector<std::size_t> points;
  for (const Vec3& X : mesh.nodes) points.push_back(g.mesh.add_point(bgeot::base_node(X[0], X[1], X[2])));
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    const std::size_t corners[4] = {points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]};
    g.mesh.add_convex(bgeot::simplex_geotrans(3, 1), corners);
  }
  g.displacement = std::make_unique<getfem::mesh_fem>(g.mesh, 3);
  g.displacement->set_finite_element(g.mesh.convex_index(), getfem::fem_descriptor("FEM_PK(3,1)"));
  g.integration = std::make_unique<getfem::mesh_im>(g.mesh);
  g.integration->set_integration_method(g.mesh.convex_index(), getfem::int_method_descriptor("IM_TETRAHEDRON(1)"));
  g.first_component.resize(mesh.nodes.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const auto components = g.displacement->ind_basic_dof_of_element(t);
    for (int c = 0; c < 4; ++c) g.first_component[mesh.tetrahedra[t][c]] = components[3 * c];
  }
  g.model.add_fem_variable("u", *g.displacement);
  g.model.add_initialized_fixed_size_data("moduli", getfem::base_vector{lambda, mu});
  getfem::add_finite_strain_elasticity_brick(g.model, *g.integration, "Compressible_Neo_Hookean_Bonet", "u", "moduli");
}

GetfemBox::~GetfemBox() = default;

void GetfemBox::SetPositions(const NodalVector& x) {
  NodalVector u = x;
  for (std::size_t n = 0; n < u.size(); ++n) u[n] -= impl_->rest[n];
  gmm::copy(impl_->ToComponents(u), impl_->model.set_real_variable("u"));
}

void GetfemBox::Assemble() { impl_->model.assembly(getfem::model::BUILD_ALL); }

NodalVector GetfemBox::Forces() const {
  return impl_->ToNodes({impl_->model.real_rhs().begin(), impl_->model.real_rhs().end()});
}

NodalVector GetfemBox::Product(const NodalVector& p) const {
  std::vector<double> product(3 * p.size());
  gmm::mult(impl_->model.real_tangent_matrix(), impl_->ToComponents(p), product);
  return impl_->ToNodes(product);
}

}  // namespace fascicle::bench
