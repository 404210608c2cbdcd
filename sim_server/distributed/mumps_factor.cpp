#include "sim_server/distributed/mumps_factor.h"

#include <algorithm>
#include <cmath>
#include <dmumps_c.h>
#include <stdexcept>

#include "common/clock.h"
#include "common/error.h"
#include "common/memory_budget.h"
#include "sim_server/sparse/blas.h"

namespace palpate::sim {
namespace {

/// The jobs of MUMPS, as its manual numbers them, in words of our own.
enum Job {
  kInitialize = -1,
  kEnd = -2,
  kAnalyse = 1,
  kFactor = 2,
  kSolve = 3,
  kReportNeed = 100,
  kReportUsed,
  kReturn
};

/// Errors in INFOG(1), as its manual numbers them.
enum Infog {
  kRemote = -1,
  kSingularPattern = -6,
  kAlsoTooSmall = -8,
  kTooSmall = -9,
  kSingular = -10,
  kNoMemory = -13,
  kNotDefinite = -40
};

constexpr int kWorldOfMpi = -987654;  // MPI_COMM_WORLD, for MUMPS
constexpr double kMega = 1e6;         // bytes, as MUMPS counts memory
constexpr int kMoreRoom = 30;         // % beyond what the analysis expects
constexpr Eigen::Index kAtOnce = 32;  // right-hand sides

/// The manual counts parameters from 1.
int& control(DMUMPS_STRUC_C& mumps, int number) {
  return mumps.icntl[number - 1];
}

[[noreturn]] void fail_as_singular(const std::string& where) {
  fail(
      "{}: the stiffness matrix is singular: the fixed nodes do not hold the body; a [[fixed]] with three "
      "that are not in line would",
      where);
}

/// One job on this rank.
void take_part(DMUMPS_STRUC_C& mumps, int job) {
  if (job == kReportNeed) {
    gather_memory(kMega * mumps.info[14]);
  } else if (job == kReportUsed) {
    gather_memory(kMega * mumps.info[21]);
  } else {
    mumps.job = job;
    dmumps_c(&mumps);
  }
}

/// Symmetric positive definite, over all ranks, the host works, too, and nothing is printed.
void begin(DMUMPS_STRUC_C& mumps) {
  mumps = {};
  mumps.comm_fortran = kWorldOfMpi;
  mumps.sym = mumps.par = 1;
  take_part(mumps, kInitialize);
  for (const int stream : {1, 2, 3}) control(mumps, stream) = -1;
  control(mumps, 4) = 0;
}

}  // namespace

struct MumpsFactor::Instance {
  DMUMPS_STRUC_C data{};

  Instance() {
    send_word(kInitialize);
    begin(data);
  }
  ~Instance() { run(kEnd); }
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  void run(int job) {
    send_word(job);
    take_part(data, job);
  }
  std::vector<RankMemory> memory(int which) {
    send_word(which);
    return gather_memory(kMega * data.info[which == kReportNeed ? 14 : 21]);
  }
};

void serve_mumps() {
  DMUMPS_STRUC_C mumps{};
  for (int word = wait_for_word(); word != kReturn; word = wait_for_word()) {
    if (word == kInitialize) {
      begin(mumps);
    } else {
      take_part(mumps, word);
    }
  }
}

void end_mumps() {
  send_word(kReturn);
}

MumpsFactor::MumpsFactor(const SparseMatrix& lower, std::span<const int> stored, FactorUse use,
                         const std::string& where, const std::function<void(const std::string&)>& report)
    : mumps_(std::make_unique<Instance>()), use_(use) {
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);  // a rank a core
  for (const int unknown : stored) stored_.push_back(unknown + 1);
  costs_.unknowns = lower.rows();
  const Time start = now();
  if (stored_.size() == static_cast<std::size_t>(lower.rows())) {
    take_all(lower, where);
    costs_.schur_s = to_seconds(now() - start);
    return;
  }
  analyse(lower, where);
  const Time analysed = now();
  report(
      fmt::format("{} unknowns, {} of them kept: {:.3g} Gflop, at most {:.3g} GB on a rank, {:.3g} GB in all",
                  lower.rows(), stored.size(), 1e-9 * costs_.flops, 1e-3 * mumps_->data.infog[15],
                  1e-3 * mumps_->data.infog[16]));
  factor(where);
  const Time factored = now();
  take_schur(where);
  costs_.stored = schur_.rows();
  costs_.analysis_s = to_seconds(analysed - start);
  costs_.factor_s = to_seconds(factored - analysed);
  costs_.schur_s = to_seconds(now() - factored);
}

MumpsFactor::~MumpsFactor() = default;

void MumpsFactor::analyse(const SparseMatrix& lower, const std::string& where) {
  DMUMPS_STRUC_C& mumps = mumps_->data;
  rows_.reserve(static_cast<std::size_t>(lower.nonZeros()));
  columns_.reserve(rows_.capacity());
  values_.reserve(rows_.capacity());
  for (Eigen::Index column = 0; column < lower.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      if (entry.row() < column) continue;  // blocks on the diagonal are whole
      values_.push_back(entry.value());
      rows_.push_back(static_cast<int>(entry.row()) + 1);
      columns_.push_back(static_cast<int>(column) + 1);
    }
  }
  mumps.n = static_cast<int>(lower.rows());
  mumps.nnz = static_cast<std::int64_t>(values_.size());
  mumps.irn = rows_.data();
  mumps.jcn = columns_.data();
  mumps.a = values_.data();
  mumps.size_schur = static_cast<int>(stored_.size());
  mumps.listvar_schur = stored_.data();
  control(mumps, 7) = 5;  // order by METIS
  control(mumps, 14) = kMoreRoom;
  control(mumps, 19) = 1;                                    // the Schur complement on rank 0
  control(mumps, 31) = use_ == FactorUse::kInverse ? 1 : 0;  // columns are dropped once S has what they give
  mumps_->run(kAnalyse);
  require("analysis", where);
  costs_.flops = mumps.rinfog[0];
  std::vector<RankMemory> need = mumps_->memory(kReportNeed);
  need.front().bytes += 2 * sizeof(double) * std::pow(static_cast<double>(stored_.size()), 2);  // S, S^-1
  const std::string shortage = shortage_of(need);
  if (!shortage.empty())
    fail("{}: {}, for the Cholesky factor of {} unknowns; take more machines, or a coarser mesh", where,
         shortage, lower.rows());
}

void MumpsFactor::factor(const std::string& where) {
  constexpr int kMostRoom = 500;  // %
  DMUMPS_STRUC_C& mumps = mumps_->data;
  const auto size = static_cast<Eigen::Index>(stored_.size());
  schur_.resize(size, size);
  mumps.schur = schur_.data();
  mumps_->run(kFactor);
  while ((mumps.infog[0] == kTooSmall || mumps.infog[0] == kAlsoTooSmall) && control(mumps, 14) < kMostRoom) {
    control(mumps, 14) *= 2;
    mumps_->run(kFactor);
  }
  require("factorisation", where);
  costs_.memory = mumps_->memory(kReportUsed);
}

/// Takes all rows where all is stored: S is A then, and MUMPS, which would have nothing to do, is not called.
void MumpsFactor::take_all(const SparseMatrix& lower, const std::string& where) {
  const auto size = static_cast<Eigen::Index>(stored_.size());
  require_memory(2.0 * sizeof(double) * static_cast<double>(size * size), free_memory(), where,
                 fmt::format("the dense stiffness matrix of {} unknowns, all of which are reached,", size),
                 "give [[tool]] a `reach` box around the part it touches");
  std::vector<int> place(stored_.size());
  for (int k = 0; k < static_cast<int>(stored_.size()); ++k)
    place[static_cast<std::size_t>(stored_[k] - 1)] = k;
  schur_ = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index column = 0; column < lower.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      const int i = place[static_cast<std::size_t>(entry.row())], j = place[static_cast<std::size_t>(column)];
      if (entry.row() >= column) schur_(std::min(i, j), std::max(i, j)) = entry.value();
    }
  }
  take_schur(where);
  costs_.stored = size;
  costs_.memory = mumps_->memory(kReportUsed);
}

/// MUMPS writes it by rows, of which only the lower triangle counts; that is the upper one by columns.
void MumpsFactor::take_schur(const std::string& where) {
  if (stored_.empty()) return;
  schur_.triangularView<Eigen::StrictlyLower>() = schur_.transpose();
  const int size = static_cast<int>(stored_.size());
  int failed = 0;
  Blas<double>::potrf("L", &size, schur_.data(), &size, &failed);
  if (failed != 0) fail_as_singular(where);
}

void MumpsFactor::require(const char* stage, const std::string& where) const {
  const int error = mumps_->data.infog[0], detail = mumps_->data.infog[1];
  if (error >= 0) return;
  if (error == kSingular || error == kSingularPattern || error == kNotDefinite) fail_as_singular(where);
  if (error == kNoMemory)
    fail("{}: memory ended in the {} of the stiffness matrix; take more machines, or a coarser mesh", where,
         stage);
  if (error == kRemote)
    fail_at_run_time("{}: the {} of the stiffness matrix failed on rank {}", where, stage, detail);
  fail_at_run_time("{}: the {} of the stiffness matrix failed: MUMPS says INFOG(1) = {}, INFOG(2) = {}",
                   where, stage, error, detail);
}

/// Forward elimination of all that is not kept, S, and back.
Eigen::MatrixXd MumpsFactor::solve(const Eigen::MatrixXd& b) const {
  if (schur_.rows() == b.rows()) return solve_all(b);
  if (use_ == FactorUse::kInverse) throw std::logic_error("a factor that was to give an inverse alone");
  DMUMPS_STRUC_C& mumps = mumps_->data;
  Eigen::MatrixXd x = b, reduced(schur_.rows(), std::min(kAtOnce, b.cols()));
  mumps.lrhs = mumps.n;
  mumps.redrhs = reduced.data();
  mumps.lredrhs = static_cast<int>(schur_.rows());
  const auto run_solve = [&](int which) {
    control(mumps, 26) = which;
    mumps_->run(kSolve);
    require("solution", "condense");
  };
  enum Icntl26 : int { kSolveAll = 0, kForward = 1, kBack = 2 };  // how far to solve with a Schur complement
  const auto lower = schur_.triangularView<Eigen::Lower>();
  for (Eigen::Index first = 0; first < b.cols(); first += kAtOnce) {
    const Eigen::Index count = std::min(kAtOnce, b.cols() - first);
    mumps.nrhs = static_cast<int>(count);
    mumps.rhs = x.col(first).data();
    if (schur_.size() == 0) {
      run_solve(kSolveAll);
      continue;
    }
    run_solve(kForward);
    lower.solveInPlace(reduced.leftCols(count));
    lower.transpose().solveInPlace(reduced.leftCols(count));
    run_solve(kBack);
  }
  return x;
}

Eigen::MatrixXd MumpsFactor::solve_all(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x(b.rows(), b.cols()), in_order = x;
  for (Eigen::Index k = 0; k < b.rows(); ++k)
    in_order.row(k) = b.row(stored_[static_cast<std::size_t>(k)] - 1);
  const auto lower = schur_.triangularView<Eigen::Lower>();
  lower.solveInPlace(in_order);
  lower.transpose().solveInPlace(in_order);
  for (Eigen::Index k = 0; k < b.rows(); ++k)
    x.row(stored_[static_cast<std::size_t>(k)] - 1) = in_order.row(k);
  return x;
}

void MumpsFactor::inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                                const std::function<void(double)>& progress) const {
  const auto is_stored = [](int unknown, int stored) { return unknown + 1 == stored; };
  if (!std::ranges::equal(unknowns, stored_, is_stored))
    throw std::logic_error("of the inverse, only what was kept can be had");
  progress(0);
  const int size = static_cast<int>(stored_.size());
  block = schur_;
  int failed = 0;
  const int stride = static_cast<int>(block.outerStride());
  Blas<double>::potri("L", &size, block.data(), &stride, &failed);
  block.triangularView<Eigen::StrictlyUpper>() = block.transpose();
  progress(1);
}

}  // namespace palpate::sim
