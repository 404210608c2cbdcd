#include "protocol/link_report.h"

#include <nlohmann/json.hpp>

namespace palpate::protocol {

Json link_report(const LinkStats& stats) {
  Json reasons = Json::object();
  for (std::size_t i = 0; i < stats.rejected_by.size(); ++i) {
    if (stats.rejected_by[i] > 0) reasons[name_of(static_cast<Verdict>(i))] = stats.rejected_by[i];
  }
  return {{"sent", stats.sent},
          {"received", stats.received},
          {"lost", stats.lost},
          {"values_lost", stats.values_lost},
          {"reordered", stats.reordered},
          {"overtaken", stats.overtaken},
          {"duplicated", stats.duplicated},
          {"implausible", stats.implausible},
          {"began_anew", stats.began_anew},
          {"rejected", stats.rejected},
          {"rejected_by", reasons}};
}

}  // namespace palpate::protocol
