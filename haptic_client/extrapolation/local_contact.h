#pragma once
#include "haptic_client/extrapolation/contact_on_patch.h"
#include "haptic_client/extrapolation/modal_memory.h"
#include "haptic_client/extrapolation/tick_memory.h"
#include "haptic_client/extrapolation/two_tangents.h"

namespace palpate::client {

/// Solves the contact of the tool with the surface near it here and now, at every tick, with the server's own
/// narrow phase and solver on the compliance of the tissue over a sample. Where F_loc, the force of that
/// small problem, differs from the server's, it is corrected: of F_n = kappa F_loc(P_n') + r, with r what is
/// left over, mostly across F_loc(P_n') (at a light touch, which tells little of kappa, along it, too),
///   F(P) = kappa F_loc(P') + c r,   c = min(3, |F_loc(P')| / |F_loc(P_n')|),   P' = P - s_n - s(t)
/// with s_n how far the organ is from rest and s how far it has moved since (`OrganMotion`). So a tissue that
/// is stiffer or softer than its model by a factor is met exactly, and what is missing fades with the
/// contact; where a sample is free, kappa is that of the place ahead, if the tool touches there (and without
/// friction or slow modes), else it stays as it was. Of a tissue that swings the slow modes are stepped here,
/// and set right by each sample
/// (`ModalMemory`), with what of them and of all the rest has relaxed; there kappa is learned where the tool
/// presses firmly alone, and r is 0: what a light touch lacks is the inertia of all that is quicker, and soon
/// gone. Where the model is not known around the tool (yet), a sample brings none, or F_loc(P_n') is not even
/// half right: `TwoTangents`, from one sample to the next. With friction, where force depends on the path,
/// F_loc(P_n') is the one that was rendered at t_n: the contact here has followed the path tick by tick, so
/// there is no state of the server's to take over, and nothing to replay; it is not rendered before it was
/// compared. Contact solved at the haptic rate on a compliance from the simulation: Peterlik et al. (2011);
/// the rest is of our own. About 50 ns a tick, and where the tool has gone on (see `ContactOnPatch`) a
/// contact solve of 10 us, one in ten above 50 us; with friction 30 us, one in ten above 130 us. A sample: 1
/// us, of a free tool expected to touch 140 us.
class LocalContact : public Extrapolator {
 public:
  static constexpr double kMostCorrection = 3;   ///< factor on the stiffness of the local model, either way
  static constexpr double kTangentReach = 1e-3;  ///< m from its place: a tangent is not used further
  /// Error of the model at the sample, of the larger force: with more of it, it is not used elsewhere.
  static constexpr double kBelievable = 0.5;

  void update(const Sample& sample) noexcept override;
  void restart() noexcept override;
  void start_tick(Time now) noexcept override {
    if (now_ != Time{}) contact_.bear(now - now_);
    now_ = now;
  }
  Vec3 force(const Vec3& p, Time t) noexcept override;
  Request request() const noexcept override { return {.at_tool = true, .ahead = true, .surface = true}; }
  bool stepped_down() const noexcept override { return !known_; }
  std::string_view substitute() const noexcept override {
    if (known_) return {};
    return without_.stepped_down() ? without_.substitute() : "two_tangents";
  }

 private:
  void compare(const Vec3& local) noexcept;
  void compare_swinging(const Vec3& local) noexcept;
  void learn_factor(const Vec3& right, const Vec3& local) noexcept;
  void compare_ahead() noexcept;
  void store(Time t, const Vec3& p_rest, const Vec3& local) noexcept;
  std::optional<Vec3> stored(Time t, const Vec3& p_rest) const noexcept;
  Vec3 at_rest(const Vec3& p, Time t) const noexcept;
  bool swings() const noexcept { return newest_.surface && newest_.surface->modes.count > 0; }
  const ModalMemory* memory() const noexcept { return swings() ? &memory_ : nullptr; }
  bool take_modes() noexcept;
  bool find_footing(const Vec3& p_rest) noexcept;
  std::optional<Vec3> follow(const Vec3& p, Time t) noexcept;
  Vec3 moved_by_others(const Vec3& rendered) const noexcept;

  /// F_loc as it was rendered.
  struct Rendered {
    Vec3 p_rest, force;  // m, where the slow modes stand at 0; N
    Mat3 tangent;        // N/m
  };

  TwoTangents without_;
  ContactOnPatch contact_;
  Sample newest_;
  OrganMotion motion_;
  ModalMemory memory_;
  Vec3 swing_ = Vec3::Zero();          // how far the slow modes have moved the surface here, m
  std::uint64_t bearing_ = 0;          // the contact solve that `memory_` stands on
  Time now_{};                         // of the tick: its rendered force is stored
  double local_size_ = 0;              // |F_loc(P_n')|, N
  double kappa_ = 1, largest_ = 0;     // -, N: of all samples
  Vec3 remainder_ = Vec3::Zero();      // r, N
  Vec3 rendered_last_ = Vec3::Zero();  // N, at the last tick that it solved
  TickMemory<Rendered> rendered_;
  bool known_ = false;  // whether the model gives the rendered force, since the newest sample
  bool following_ =
      false;  // or follows the path without being rendered, as with friction nothing can be compared yet
};

}  // namespace palpate::client
