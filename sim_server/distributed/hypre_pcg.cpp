#include "sim_server/distributed/hypre_pcg.h"

#include <HYPRE.h>
#include <HYPRE_krylov.h>
#include <HYPRE_parcsr_ls.h>
#include <array>
#include <fmt/core.h>
#include <mpi.h>

#include "common/clock.h"
#include "common/error.h"
#include "common/memory_budget.h"

namespace palpate::sim {
namespace {

/// What rank 0 has the others do.
enum class PcgWord { kReturn, kShareOut, kSetUp, kSolve, kForget, kTellNeed, kTellUsed };

void send(PcgWord word) {
  send_word(static_cast<int>(word));
}

constexpr int kPerNode = 3;           // unknowns
constexpr double kTolerance = 1e-11;  // of a residual, relative to its right-hand side
constexpr int kMostIterations = 1000;
constexpr double kBytesPerEntry = 60;  // of the matrix: with its multigrid, while that is set up
constexpr int kTag = 1;

int count_of_ranks() {
  int count = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &count);
  return count;
}

/// Nodes in the order in which they are reached from one, neighbour by neighbour, so that a range of them is
/// a layer of the body that meets few others.
std::vector<int> order_by_layers(const SparseMatrix& whole) {
  const auto nodes = static_cast<std::size_t>(whole.rows()) / kPerNode;
  std::vector<int> order;
  std::vector<char> reached(nodes, 0);
  for (std::size_t start = 0, next = 0; start < nodes; ++start) {
    if (reached[start] != 0) continue;
    order.push_back(static_cast<int>(start));
    for (reached[start] = 1; next < order.size(); ++next) {
      for (SparseMatrix::InnerIterator entry(whole, kPerNode * order[next]); entry; ++entry) {
        const auto node = static_cast<std::size_t>(entry.row()) / kPerNode;
        if (std::exchange(reached[node], 1) == 0) order.push_back(static_cast<int>(node));
      }
    }
  }
  return order;
}

/// Where each unknown goes: those of a node stay together.
Eigen::VectorXi places_by_layers(const SparseMatrix& whole) {
  const std::vector<int> order = order_by_layers(whole);
  Eigen::VectorXi places(whole.rows());
  for (std::size_t k = 0; k < order.size(); ++k) {
    for (int axis = 0; axis < kPerNode; ++axis)
      places[kPerNode * order[k] + axis] = kPerNode * static_cast<int>(k) + axis;
  }
  return places;
}

/// The first row of each rank, and the end: as many nodes for each, but for one.
std::vector<int> first_rows(Eigen::Index unknowns, int ranks) {
  std::vector<int> first;
  for (int rank = 0; rank <= ranks; ++rank)
    first.push_back(static_cast<int>(kPerNode * (unknowns / kPerNode * rank / ranks)));
  return first;
}

/// Rows of a matrix that follow each other.
struct Rows {
  int first = 0;
  std::vector<int> lengths{}, columns{};
  std::vector<double> values{};
};

/// Of a symmetric matrix, so that columns are rows.
Rows rows_of(const SparseMatrix& whole, int first, int end) {
  Rows rows{first};
  for (int row = first; row < end; ++row) {
    const std::size_t before = rows.values.size();
    for (SparseMatrix::InnerIterator entry(whole, row); entry; ++entry) {
      rows.columns.push_back(static_cast<int>(entry.row()));
      rows.values.push_back(entry.value());
    }
    rows.lengths.push_back(static_cast<int>(rows.values.size() - before));
  }
  return rows;
}

void send_rows(const Rows& rows, int rank) {
  const std::array<int, 3> sizes{rows.first, static_cast<int>(rows.lengths.size()),
                                 static_cast<int>(rows.values.size())};
  MPI_Send(sizes.data(), 3, MPI_INT, rank, kTag, MPI_COMM_WORLD);
  MPI_Send(rows.lengths.data(), sizes[1], MPI_INT, rank, kTag, MPI_COMM_WORLD);
  MPI_Send(rows.columns.data(), sizes[2], MPI_INT, rank, kTag, MPI_COMM_WORLD);
  MPI_Send(rows.values.data(), sizes[2], MPI_DOUBLE, rank, kTag, MPI_COMM_WORLD);
}

Rows receive_rows() {
  const auto receive = [](void* data, int count, MPI_Datatype type) {
    MPI_Recv(data, count, type, 0, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  };
  std::array<int, 3> sizes{};
  receive(sizes.data(), 3, MPI_INT);
  Rows rows{sizes[0]};
  rows.lengths.resize(static_cast<std::size_t>(sizes[1]));
  rows.columns.resize(static_cast<std::size_t>(sizes[2]));
  rows.values.resize(rows.columns.size());
  receive(rows.lengths.data(), sizes[1], MPI_INT);
  receive(rows.columns.data(), sizes[2], MPI_INT);
  receive(rows.values.data(), sizes[2], MPI_DOUBLE);
  return rows;
}

}  // namespace

/// What one rank has of the matrix, the multigrid and the vectors.
class HyprePcg::Share {
 public:
  explicit Share(const Rows& rows)
      : first_(rows.first),
        count_(static_cast<int>(rows.lengths.size())),
        b_(first_, count_),
        x_(first_, count_) {
    const int last = first_ + count_ - 1;
    HYPRE_IJMatrixCreate(MPI_COMM_WORLD, first_, last, first_, last, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    HYPRE_IJMatrixSetRowSizes(matrix_, rows.lengths.data());
    HYPRE_IJMatrixInitialize(matrix_);
    std::vector<int> lengths = rows.lengths, numbers;
    for (int row = first_; row <= last; ++row) numbers.push_back(row);
    HYPRE_IJMatrixSetValues(matrix_, count_, lengths.data(), numbers.data(), rows.columns.data(),
                            rows.values.data());
    HYPRE_IJMatrixAssemble(matrix_);
  }
  ~Share() {
    if (pcg_ != nullptr) HYPRE_ParCSRPCGDestroy(pcg_);
    if (multigrid_ != nullptr) HYPRE_BoomerAMGDestroy(multigrid_);
    HYPRE_IJMatrixDestroy(matrix_);
  }
  Share(const Share&) = delete;
  Share& operator=(const Share&) = delete;

  /// The three directions are coarsened apart (the unknown approach). Of 4 to 28 thousand unknowns a
  /// threshold of 0.25 and PMIS took the least time of 0.15 to 0.9, nodal coarsening, HMIS, Falgout, and a
  /// first level coarsened aggressively, which takes half the memory and twice the iterations.
  void set_up() {
    constexpr int kPmis = 8, kExtendedPlusI = 6, kSymmetricGaussSeidel = 8;
    HYPRE_BoomerAMGCreate(&multigrid_);
    HYPRE_BoomerAMGSetNumFunctions(multigrid_, kPerNode);
    HYPRE_BoomerAMGSetCoarsenType(multigrid_, kPmis);
    HYPRE_BoomerAMGSetInterpType(multigrid_, kExtendedPlusI);
    HYPRE_BoomerAMGSetPMaxElmts(multigrid_, 4);
    HYPRE_BoomerAMGSetStrongThreshold(multigrid_, 0.25);
    HYPRE_BoomerAMGSetRelaxType(multigrid_, kSymmetricGaussSeidel);
    HYPRE_BoomerAMGSetTol(multigrid_, 0);
    HYPRE_BoomerAMGSetMaxIter(multigrid_, 1);
    HYPRE_BoomerAMGSetPrintLevel(multigrid_, 0);
    HYPRE_ParCSRPCGCreate(MPI_COMM_WORLD, &pcg_);
    HYPRE_PCGSetTol(pcg_, kTolerance);
    HYPRE_PCGSetTwoNorm(pcg_, 1);
    HYPRE_PCGSetMaxIter(pcg_, kMostIterations);
    HYPRE_ParCSRPCGSetPrecond(pcg_, HYPRE_BoomerAMGSolve, HYPRE_BoomerAMGSetup, multigrid_);
    HYPRE_ParCSRPCGSetup(pcg_, object(), b_.object(), x_.object());
  }

  /// The right-hand side comes from rank 0, and the solution goes there.
  void solve(const double* all_b, double* all_x) {
    std::vector<int> counts(static_cast<std::size_t>(count_of_ranks())), firsts(counts.size());
    MPI_Allgather(&count_, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
    MPI_Allgather(&first_, 1, MPI_INT, firsts.data(), 1, MPI_INT, MPI_COMM_WORLD);
    std::vector<double> own(static_cast<std::size_t>(count_));
    x_.set(own);
    MPI_Scatterv(all_b, counts.data(), firsts.data(), MPI_DOUBLE, own.data(), count_, MPI_DOUBLE, 0,
                 MPI_COMM_WORLD);
    b_.set(own);
    HYPRE_ClearAllErrors();  // that it did not converge is told by the residual
    HYPRE_ParCSRPCGSolve(pcg_, object(), b_.object(), x_.object());
    x_.get(own);
    MPI_Gatherv(own.data(), count_, MPI_DOUBLE, all_x, counts.data(), firsts.data(), MPI_DOUBLE, 0,
                MPI_COMM_WORLD);
  }

  int iterations() const {
    HYPRE_Int count = 0;
    HYPRE_PCGGetNumIterations(pcg_, &count);
    return count;
  }
  double relative_residual() const {
    double residual = 0;
    HYPRE_PCGGetFinalRelativeResidualNorm(pcg_, &residual);
    return residual;
  }

 private:
  /// A vector of which this rank has some rows.
  class Vector {
   public:
    Vector(int first, int count) : count_(count) {
      HYPRE_IJVectorCreate(MPI_COMM_WORLD, first, first + count - 1, &vector_);
      HYPRE_IJVectorSetObjectType(vector_, HYPRE_PARCSR);
      set(std::vector<double>(static_cast<std::size_t>(count)));
    }
    ~Vector() { HYPRE_IJVectorDestroy(vector_); }
    Vector(const Vector&) = delete;
    Vector& operator=(const Vector&) = delete;

    void set(const std::vector<double>& values) {
      HYPRE_IJVectorInitialize(vector_);
      HYPRE_IJVectorSetValues(vector_, count_, nullptr, values.data());
      HYPRE_IJVectorAssemble(vector_);
    }
    void get(std::vector<double>& values) const {
      HYPRE_IJVectorGetValues(vector_, count_, nullptr, values.data());
    }
    HYPRE_ParVector object() const {
      void* object = nullptr;
      HYPRE_IJVectorGetObject(vector_, &object);
      return static_cast<HYPRE_ParVector>(object);
    }

   private:
    HYPRE_IJVector vector_{};
    int count_;
  };

  HYPRE_ParCSRMatrix object() const {
    void* object = nullptr;
    HYPRE_IJMatrixGetObject(matrix_, &object);
    return static_cast<HYPRE_ParCSRMatrix>(object);
  }

  int first_, count_;
  HYPRE_IJMatrix matrix_{};
  HYPRE_Solver pcg_{}, multigrid_{};
  Vector b_, x_;
};

HyprePcg::HyprePcg(const SparseMatrix& lower, const std::string& where,
                   const std::function<void(const std::string&)>& tell)
    : where_(where) {
  const Time start = now();
  HYPRE_Init();
  share_out(lower, tell);
  send(PcgWord::kSetUp);
  share_->set_up();
  send(PcgWord::kTellUsed);
  costs_->memory = gather_memory(resident_memory());
  costs_->setup_s = to_seconds(now() - start);
}

HyprePcg::~HyprePcg() {
  send(PcgWord::kForget);
}

/// The whole matrix is on rank 0 only until each has its rows.
void HyprePcg::share_out(const SparseMatrix& lower, const std::function<void(const std::string&)>& tell) {
  const SparseMatrix half = lower.triangularView<Eigen::Lower>();  // blocks on the diagonal are whole
  SparseMatrix whole = half.selfadjointView<Eigen::Lower>();
  places_ = places_by_layers(whole);
  whole = half.selfadjointView<Eigen::Lower>().twistedBy(Eigen::PermutationWrapper<Eigen::VectorXi>(places_));
  costs_->unknowns = whole.rows();
  costs_->entries = whole.nonZeros();
  const int ranks = count_of_ranks();
  const double need = kBytesPerEntry * static_cast<double>(whole.nonZeros()) / ranks;
  tell(fmt::format("{} unknowns, {:.3g} million entries: some {} on each rank", whole.rows(),
                   1e-6 * static_cast<double>(whole.nonZeros()), bytes_text(need)));
  send(PcgWord::kTellNeed);
  MPI_Bcast(const_cast<double*>(&need), 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  const std::string shortage = shortage_of(gather_memory(need));
  if (!shortage.empty())
    fail("{}: {}, for conjugate gradients with {} unknowns; take more machines, or a coarser mesh", where_,
         shortage, whole.rows());
  const std::vector<int> first = first_rows(whole.rows(), ranks);
  send(PcgWord::kShareOut);
  for (int rank = 1; rank < ranks; ++rank)
    send_rows(
        rows_of(whole, first[static_cast<std::size_t>(rank)], first[static_cast<std::size_t>(rank) + 1]),
        rank);
  const Rows own = rows_of(whole, 0, first[1]);
  whole = {};
  share_ = std::make_unique<Share>(own);
}

Eigen::VectorXd HyprePcg::solve_one(const Eigen::VectorXd& b) const {
  Eigen::VectorXd placed = Eigen::VectorXd::Zero(b.size());
  placed(places_) = b;
  if (placed.isZero(0)) return placed;
  Eigen::VectorXd x(b.size());
  send(PcgWord::kSolve);
  share_->solve(placed.data(), x.data());
  ++costs_->systems;
  costs_->iterations += share_->iterations();
  const double residual = share_->relative_residual();
  if (!(residual <= kTolerance))
    fail(
        "{}: conjugate gradients came to a residual of {:.2g} in {} iterations, and {:g} is asked for; a "
        "mesh "
        "with "
        "fewer slivers (`sim_server mesh info`), or a factor (without --iterative), would do",
        where_, residual, share_->iterations(), kTolerance);
  return x(places_);
}

Eigen::MatrixXd HyprePcg::solve(const Eigen::MatrixXd& b) const {
  const Time start = now();
  Eigen::MatrixXd x(b.rows(), b.cols());
  for (Eigen::Index i = 0; i < b.cols(); ++i) x.col(i) = solve_one(b.col(i));
  costs_->solve_s += to_seconds(now() - start);
  return x;
}

void HyprePcg::inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                             const std::function<void(double)>& progress) const {
  const auto size = static_cast<Eigen::Index>(unknowns.size());
  const Eigen::Map<const Eigen::VectorXi> kept(unknowns.data(), size);
  for (Eigen::Index i = 0; i < size; ++i) {
    progress(static_cast<double>(i) / static_cast<double>(size));
    block.col(i) = solve(Eigen::VectorXd::Unit(costs_->unknowns, kept[i]))(kept, 0);
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) block(i, j) = block(j, i) = 0.5 * (block(i, j) + block(j, i));
  }
  progress(1);
}

void serve_hypre() {
  HYPRE_Init();
  std::unique_ptr<HyprePcg::Share> share;
  while (true) {
    const auto word = static_cast<PcgWord>(wait_for_word());
    if (word == PcgWord::kReturn) return;
    if (word == PcgWord::kTellNeed) {
      double need = 0;
      MPI_Bcast(&need, 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
      gather_memory(need);
    } else if (word == PcgWord::kShareOut) {
      share = std::make_unique<HyprePcg::Share>(receive_rows());
    } else if (word == PcgWord::kSetUp) {
      share->set_up();
    } else if (word == PcgWord::kTellUsed) {
      gather_memory(resident_memory());
    } else if (word == PcgWord::kSolve) {
      share->solve(nullptr, nullptr);
    } else {
      share.reset();
    }
  }
}

void end_hypre() {
  send(PcgWord::kReturn);
}

}  // namespace palpate::sim
