#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::client {

/// How stiff a wall each law keeps stable, by the age of its samples: the least over linear and Hertzian
/// walls and three hands, at 30 samples a second with passivity, of `studies stability --by-delay` (5 seeds,
/// within 5 %). The least up to the next age of the study, so that a longer age never gives a higher limit,
/// as the walls of the study happen to; beyond the last: not known. N/m.
std::optional<double> stable_to(std::string_view law, double age_ms);

/// What a test of a link measured, of which a verdict is made.
struct TestedLink {
  std::string law;
  double seconds = 0;                  ///< that the test took
  double age_p99_ms = 0;               ///< of the samples, as they came
  double stiffest_n_m = 0;             ///< that the session rendered; 0: nothing was touched
  double samples_hz = 0, rate_hz = 0;  ///< that came; that the server aims for, 0: as fast as it can
  double loss_percent = 0;             ///< of samples
  bool connected = false;
  double longest_gap_ms = 0;          ///< between two samples
  std::uint64_t gaps = 0, faded = 0;  ///< longer than 100 ms; times that the force faded
  double sent_mbit_s = 0;             ///< with the headers of IP and UDP
  double uplink_loss_percent = 0;     ///< of datagrams to the server, as it counts them
  double slow_percent = 0;            ///< of the time, in which less travelled than a session has to tell
  bool drops_large = false;           ///< no page came of those requested (`LinkFigures::drops_large`)
};

enum class Grade { kPass, kWarn, kFail };

struct Verdict {
  Grade grade = Grade::kPass;
  std::vector<std::string>
      reasons;  ///< sentences: of a slow link; what law, age and stiffness the grade is of; then of the rest
  /// Causes and what helps; a sentence each, for each reason to give no better grade, in the same order. A
  /// slow link stands for what its queue makes late or drops; bursts (a gap above 300 ms, or more than one
  /// gap in 3 s) stand for all that they spoil.
  std::vector<std::string> remedies{};
};

/// FAIL: no session, ages or gaps at which the force fades (300 ms), a surface whose pages never come, or a
/// stiffness above what the law keeps stable. WARN: within a factor of two of it, ages above 36 ms, which a
/// hand notices in a spring (Rank et al.), gaps above 100 ms, a link that is too slow for all that a session
/// sends, more than 5 % of datagrams lost either way, or fewer than 90 % of the samples aimed for.
Verdict judge(const TestedLink& link);

const char* name_of(Grade grade);

}  // namespace palpate::client
