#pragma once
#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <optional>

#include "common/background_job.h"
#include "sim_server/elasticity/solid.h"
#include "sim_server/mesh/cut_mesh.h"
#include "sim_server/solvers/dynamics_settings.h"
#include "sim_server/sparse/sparse_cholesky.h"

namespace palpate::sim {

/// The matrix of Newton's method in a step of implicit dynamics, A = (1 + beta c) K + (c^2 + alpha c) M, at
/// the place where it was built last, and its factor. With c = 0 that of a static equilibrium, K. One thread
/// at a time.
class NewtonMatrix {
 public:
  /// K of the solid at rest, factored; of one that flies with some inertia. Throws `Error`, beginning with
  /// `where`, when `dofs`, which must outlive this, do not hold it. `precision` of the factor: if absent,
  /// what iterations in time make up for.
  NewtonMatrix(const Solid& solid, const FreeDofs& dofs, const DynamicsSettings& settings,
               const std::string& where, std::optional<SparseCholesky::Precision> precision = {});

  /// A of the solid at `x` (nodes, m) with these masses (nodes, kg), factored. Where A is not positive
  /// definite, as of a body about to buckle, with more inertia.
  void build(const Solid& solid, std::span<const Vec3> x, std::span<const double> masses,
             const Viscosity& viscosity, double c, Solid::Scratch& scratch);
  /// The stiffness of a tetrahedron, N/m: of each pair of its corners (i, j <= i), by rows.
  using Blocks = std::array<Mat3, 10>;
  /// A tetrahedron gets another shape, or other corners. These were its blocks, at rest in the frames of its
  /// nodes (`to_rest`): kept, unless it did so before since the last `build`.
  void note_shape(int tetrahedron, const Blocks& blocks) { shapes_.try_emplace(tetrahedron, blocks); }
  /// A block of rows of node i and columns of j, N/m, as if neither had turned, by the last `turn_to`.
  Mat3 to_rest(int i, int j, const Mat3& block) const;
  /// Splits these nodes in two, none of which is held; all tetrahedra around them have been noted. Until the
  /// next `build`, which takes the new pattern, A is bordered by the ways of the copies from their nodes
  /// (augmented matrices: Yeung, Crouch and Pothen 2016, ACM Trans. Graph. 35:18): the factor, of the body as
  /// if each pair still were one, serves on.
  void part(std::span<const Split> splits);
  /// Makes the border of A since the last `part`, of the solid as it is now. Returns how many copies it took;
  /// 0: nothing was to be done. O(nodes + noted tetrahedra), and of as many nodes two times `columns`.
  int make_border(const Solid& solid, std::span<const double> masses);
  /// True if the last `build` came to a factor: no inertia was enough for a body that is turned inside out.
  bool is_definite() const { return definite_; }
  /// True if A of the last `build` was not positive definite, and got more inertia.
  bool is_shifted() const { return shifted_; }
  /// True if nodes have been split since the last `build`.
  bool is_bordered() const { return !copies_.empty(); }
  /// True if the factor is of a body of so different a shape that the last border does not fit it.
  bool border_misfits() const { return border_misfits_; }
  /// The factor is not to be used any more.
  void expire() { c_ = 0; }
  /// Checks whether the factor of the last `build` lacks digits, where iterations with it converge slowly;
  /// the next is then made in double precision. Costs a solve.
  void check_precision();
  /// A^-1 b of the factor, and of the border, for columns b over the unknowns.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  /// Tells where the body is now (nodes, m), for `turned_solve`.
  void turn_to(const Solid& solid, std::span<const Vec3> x);
  /// Q A^-1 Q^T b, Q turning each node as the body there has turned since A was built: a body that was only
  /// carried and turned about has that matrix, so the factor serves as long as nothing but that happens.
  /// Before the first `turn_to`, and of the linear law without floating pieces, `solve`.
  Eigen::VectorXd turned_solve(const Eigen::VectorXd& b) const;
  /// A^-1 of unit forces on the three unknowns from each of `first` on: (unknowns x 3 first.size()); of a
  /// factor in single precision by one step of refinement, which squares its error, where the first three
  /// leave more than `enough` of them, and where none is bordered.
  Eigen::MatrixXd columns(std::span<const int> first, double enough) const;

  /// c of the last `build`, 1/s; 0 before the first, and since `expire`.
  double c() const { return c_; }
  /// Returns the mean diagonal entry of K at rest, N/m.
  double mean_diagonal() const { return mean_diagonal_; }
  /// Returns the largest diagonal entry of the factored A or K, N/m.
  double largest_diagonal() const { return matrix_.lower().diagonal().maxCoeff(); }
  const SparseCholesky& factor() const { return factor_; }
  std::size_t bytes() const {
    return matrix_.bytes() + factor_.bytes() +
           static_cast<std::size_t>(border_.size() + response_.size()) * sizeof(double);
  }

 private:
  /// Pair of nodes that were one when A was built.
  struct Copy {
    int node, copy;
  };
  int first_of(int node) const { return dofs_->first[static_cast<std::size_t>(node)]; }
  void add_to_border(std::span<const int> copy_of, int i, int j, const Mat3& block);
  void use_border();
  /// v, each node of it turned by its Q, or by Q^T.
  Eigen::VectorXd turned(const Eigen::VectorXd& v, bool back) const;

  const FreeDofs* dofs_;
  double alpha_, beta_;
  StiffnessMatrix matrix_;
  double mean_diagonal_;  // N/m
  SparseCholesky factor_;
  double c_ = 0;
  double inertia_ = 0;            // 1/s^2, what masses are times in A
  std::map<int, Blocks> shapes_;  // since the last `build`, of tetrahedra
  std::vector<Copy> copies_;      // since the last `build`, in order
  bool border_is_made_ = true, border_misfits_ = false, definite_ = true, shifted_ = false;
  // By copies, three ways each, N/m: how forces follow those ways, on the body as if none had become two, and
  // on the copies; what the body does against the first; and the Schur complement of the whole.
  Eigen::MatrixXd border_, corner_, response_;
  Eigen::MatrixXd schur_;           // its Cholesky factor, in the lower triangle
  double more_inertia_ = 0;         // 1/s^2, the last that an indefinite A was given
  std::vector<Mat3> built_turned_;  // (nodes) how they had turned where A was built; empty: not at all
  std::vector<Mat3> turns_;         // (nodes) Q, or empty: none has turned
};

/// Columns of A^-1.
struct Columns {
  std::vector<int> first;  ///< (n) unknowns from each of which on three columns are
  Eigen::MatrixXd values;  ///< (unknowns x 3n), m/N
};

/// A second `NewtonMatrix` that a background thread makes ready while steps go on with the first
/// (Courtecuisse et al. 2010, Prog. Biophys. Mol. Biol. 103:159). The thread reads the body, which must
/// outlive this, and its own copy of all that changes: where tetrahedra may be removed, also of the body. A
/// value: a copy shares the matrix until either of the two changes it.
class BackgroundMatrix {
 public:
  BackgroundMatrix(const Solid& solid, const FreeDofs& dofs, const DynamicsSettings& settings,
                   const std::string& where);
  /// Starts with A of the solid at `x`, and its columns from these unknowns on. The one begun before must
  /// have been exchanged.
  void begin(std::span<const Vec3> x, std::span<const double> masses, const Viscosity& viscosity, double c,
             std::vector<int> first);
  /// Removes these tetrahedra from the body of the next `begin`.
  void remove(std::span<const int> tetrahedra) {
    removed_.insert(removed_.end(), tetrahedra.begin(), tetrahedra.end());
  }
  /// Notes a shape as `NewtonMatrix` does, for the matrix that has begun.
  void note_shape(int tetrahedron, const NewtonMatrix::Blocks& blocks) {
    begun() ? static_cast<void>(shapes_.try_emplace(tetrahedron, blocks))
            : own_work().matrix.note_shape(tetrahedron, blocks);
  }
  /// Tetrahedra of the solid have other shapes, and these nodes became two: what was begun will be bordered
  /// (`NewtonMatrix::part`), and the next `begin` is of the solid as it is then.
  void part(std::span<const Split> splits);
  bool begun() const { return job_.has_started(); }
  /// Waits for the thread, so that this can be copied.
  void wait() const { job_.wait(); }
  /// Waits for it, and exchanges it for `matrix`, unless it is not definite. Returns whether it did. Throws
  /// what the thread threw: the next one can be begun all the same.
  bool exchange(NewtonMatrix& matrix);
  /// Returns the columns that came with the last exchange. Valid until the next exchange.
  const Columns& columns() const { return given_; }
  /// Known beforehand: asked for while the thread works, too.
  std::size_t bytes() const { return bytes_; }

 private:
  /// Data of the thread, which owns it between `begin` and `exchange`.
  struct Work {
    Work(const Solid& body, const FreeDofs& dofs, const DynamicsSettings& settings, const std::string& where);
    const Solid* solid;
    std::optional<Solid> own;  // of a body that may be cut
    Solid::Scratch scratch;
    NewtonMatrix matrix;
    std::vector<Vec3> x;
    std::vector<double> masses;
    std::vector<Mat3> memory;
    Columns made = {};
  };
  Work& own_work();
  void catch_up();

  std::vector<int> removed_;                    // since the body of the work was brought up to date
  bool outdated_ = false;                       // it was parted since
  std::map<int, NewtonMatrix::Blocks> shapes_;  // since what has begun
  std::vector<Split> splits_;                   // the same
  double tolerance_;
  std::shared_ptr<Work> work_;
  std::size_t bytes_;
  Columns given_;
  BackgroundJob<bool> job_;  // last: ends before what it works on
};

}  // namespace palpate::sim
