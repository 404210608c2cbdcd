#pragma once
#include <Eigen/Core>
#include <cassert>

namespace palpate {

/// A matrix of any shape up to a capacity, without allocation. Its columns follow each other in memory: a
/// small problem stays in the cache, however large the largest that there is room for.
class BoundedMatrix : public Eigen::Map<Eigen::MatrixXd> {
 public:
  BoundedMatrix() : Map(nullptr, 0, 0) {}
  BoundedMatrix(Eigen::Index rows, Eigen::Index cols) : BoundedMatrix() { reserve(rows, cols); }
  BoundedMatrix(const BoundedMatrix& other) : BoundedMatrix() { *this = other; }
  BoundedMatrix& operator=(const BoundedMatrix& other) {
    values_ = other.values_;
    seat(other.rows(), other.cols());
    return *this;
  }
  BoundedMatrix(BoundedMatrix&& other) noexcept : BoundedMatrix() { *this = std::move(other); }
  BoundedMatrix& operator=(BoundedMatrix&& other) noexcept {
    values_.swap(other.values_);
    const Eigen::Index rows = other.rows(), cols = other.cols();
    other.seat(0, 0);
    seat(rows, cols);
    return *this;
  }
  using Map::operator=;

  /// Allocates room for that shape, and has it.
  void reserve(Eigen::Index rows, Eigen::Index cols) {
    values_.resize(rows * cols);
    seat(rows, cols);
  }
  /// Has that shape from here on; what it holds is undefined. Does not allocate.
  void shape(Eigen::Index rows, Eigen::Index cols) noexcept {
    assert(rows * cols <= values_.size());
    seat(rows, cols);
  }
  std::size_t bytes() const { return static_cast<std::size_t>(values_.size()) * sizeof(double); }

 private:
  void seat(Eigen::Index rows, Eigen::Index cols) noexcept {
    new (static_cast<Map*>(this)) Map(values_.data(), rows, cols);  // as Eigen's manual has it
  }

  Eigen::VectorXd values_;
};

}  // namespace palpate
