#include "haptic_client/device/spacemouse_reports.h"

#include <algorithm>
#include <array>

namespace palpate::client {
namespace {

constexpr std::uint16_t kLogitech = 0x046d, k3Dconnexion = 0x256f;

struct Model {
  UsbId id;
  const char* name;
};
constexpr const char* kUnnamed = "SpaceMouse";
constexpr std::array kModels{
    Model{{kLogitech, 0xc603}, "SpaceMouse Plus XT"},
    Model{{kLogitech, 0xc605}, "CadMan"},
    Model{{kLogitech, 0xc606}, "SpaceMouse Classic"},
    Model{{kLogitech, 0xc621}, "SpaceBall 5000"},
    Model{{kLogitech, 0xc623}, "SpaceTraveler"},
    Model{{kLogitech, 0xc625}, "SpacePilot"},
    Model{{kLogitech, 0xc626}, "SpaceNavigator"},
    Model{{kLogitech, 0xc627}, "SpaceExplorer"},
    Model{{kLogitech, 0xc628}, "SpaceNavigator for Notebooks"},
    Model{{kLogitech, 0xc629}, "SpacePilot Pro"},
    Model{{kLogitech, 0xc62b}, "SpaceMouse Pro"},
    Model{{kLogitech, 0xc640}, "NuLOOQ"},
    Model{{k3Dconnexion, 0xc62e}, "SpaceMouse Wireless"},
    Model{{k3Dconnexion, 0xc62f}, "SpaceMouse Wireless (receiver)"},
    Model{{k3Dconnexion, 0xc631}, "SpaceMouse Pro Wireless"},
    Model{{k3Dconnexion, 0xc632}, "SpaceMouse Pro Wireless (receiver)"},
    Model{{k3Dconnexion, 0xc633}, "SpaceMouse Enterprise"},
    Model{{k3Dconnexion, 0xc635}, "SpaceMouse Compact"},
    Model{{k3Dconnexion, 0xc636}, "SpaceMouse Module"},
    Model{{k3Dconnexion, 0xc638}, kUnnamed},
    Model{{k3Dconnexion, 0xc63a}, kUnnamed},
};

constexpr auto kIds = [] {
  std::array<UsbId, kModels.size()> ids{};
  std::ranges::transform(kModels, ids.begin(), [](const Model& model) { return model.id; });
  return ids;
}();

enum class ReportNumber : std::uint8_t { kMotion = 1, kButtons = 3 };
constexpr std::size_t kTranslation = 7, kSixAxes = 13, kLeastButtons = 3;  // bytes, with the report's number

std::uint16_t number_at(std::span<const std::byte> report, std::size_t at) {
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(report[at]) |
                                    std::to_integer<unsigned>(report[at + 1]) << 8);
}

}  // namespace

std::span<const UsbId> spacemouse_ids() noexcept {
  return kIds;
}

const char* spacemouse_name(const UsbId& id) noexcept {
  const auto model = std::ranges::find_if(kModels, [&](const Model& m) { return m.id == id; });
  return model == kModels.end() ? kUnnamed : model->name;
}

double spacemouse_response(int raw) noexcept {
  const int size = std::min(raw < 0 ? -raw : raw, kSpaceMouseFull) - kSpaceMouseDeadBand;
  if (size <= 0) return 0;
  const double fraction = static_cast<double>(size) / (kSpaceMouseFull - kSpaceMouseDeadBand);
  return raw < 0 ? -fraction * fraction : fraction * fraction;
}

bool take_spacemouse_report(std::span<const std::byte> report, SpaceMouseState& state) noexcept {
  if (report.empty()) return false;
  const auto number = static_cast<ReportNumber>(report[0]);
  if (number == ReportNumber::kButtons && report.size() >= kLeastButtons)
    state.buttons = number_at(report, 1);
  if (number != ReportNumber::kMotion || (report.size() != kTranslation && report.size() != kSixAxes))
    return false;
  const auto axis = [&](std::size_t i) {
    return spacemouse_response(static_cast<std::int16_t>(number_at(report, 1 + 2 * i)));
  };
  state.push_D = {axis(0), -axis(2), axis(1)};  // raw: x right, y towards the user, z down
  return true;
}

}  // namespace palpate::client
