#include "sim_server/viewer/texts.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/perception.h"
#include "common/report.h"

namespace palpate::sim {
namespace {

/// Rounds as a 32-bit float does: no page needs more digits.
double brief(double value) {
  return std::isfinite(value) ? std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr) : 0;
}
Json brief(const Vec3& v) {
  return {brief(v[0]), brief(v[1]), brief(v[2])};
}
Json number_or_null(double value) {
  return std::isfinite(value) ? Json(brief(value)) : Json(nullptr);
}
template <std::size_t N>
std::string text_of(const std::array<char, N>& chars) {
  return {chars.data(), strnlen(chars.data(), N)};
}
/// JSON of what may be no UTF-8, as a file's name.
std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json tool_json(const Tool& tool) {
  Json json{{"shape", tool.is_sphere() ? "sphere" : "capsule"}, {"radius", brief(tool.radius)}};
  if (tool.length > 0) json["length"] = brief(tool.length);
  json["trocar"] = tool.trocar ? brief(tool.trocar->pivot_W) : Json(nullptr);
  if (tool.trocar) json["shaft_radius"] = brief(tool.trocar->shaft_radius);
  json["axis"] = {0, 0, 1};
  return json;
}

Json loads_json(const SeenTool& tool) {
  Json loads = Json::array();
  for (const VertexLoad& load : std::span(tool.loads).first(tool.load_count)) {
    const Vec3 f = load.force.cast<float>().cast<double>();
    loads.push_back({load.vertex, brief(f[0]), brief(f[1]), brief(f[2])});
  }
  return loads;
}

Json error_json(const DiscretisationError& error) {
  return {{"percent", error.known() ? Json(brief(static_cast<double>(error.percent))) : Json(nullptr)},
          {"source", name_of(error.source)}};
}

Json seen_json(const SeenTool& tool) {
  const Quat& q = tool.pose.q_W;
  return {
      {"held", tool.held},
      {"p", brief(tool.pose.p_W)},
      {"q", {brief(q.w()), brief(q.x()), brief(q.y()), brief(q.z())}},
      {"f", brief(tool.f_W)},
      {"contact", tool.contact},
      {"flagged", tool.flagged},
      {"flagged_samples", tool.flagged_samples},
      {"errors", {{"mesh", error_json(tool.errors.mesh)}, {"time_step", error_json(tool.errors.time_step)}}},
      {"loads", loads_json(tool)}};
}

Json peers_json(std::span<const SeenPeer> peers) {
  Json json = Json::array();
  for (std::size_t i = 0; i < peers.size(); ++i) {
    if (!peers[i].held) continue;
    json.push_back({{"tool", i},
                    {"address", text_of(peers[i].address)},
                    {"loss_percent", brief(peers[i].loss_percent)},
                    {"rate_hz", brief(peers[i].rate_hz)}});
  }
  return json;
}

}  // namespace

std::string scene_text(const SceneFacts& scene, bool may_control) {
  Json tools = Json::array();
  for (const Tool& tool : scene.tools) tools.push_back(tool_json(tool));
  Json json{{"title", scene.title},
            {"file", scene.file},
            {"model", scene.model},
            {"rate_hz", brief(scene.rate_hz)},
            {"tools", tools},
            {"control", may_control},
            {"pausable", may_control && scene.pausable},
            {"recorded", scene.recorded},
            {"blades", scene.blades},
            {"fields", scene.fields}};
  if (may_control) json["scenes"] = scene.gallery;
  return dumped({{"scene", json}});
}

namespace {

Json resection_json(const std::optional<SeenResection>& resection) {
  if (!resection) return nullptr;
  return {{"tetrahedra", resection->tetrahedra},
          {"volume", brief(resection->volume)},
          {"cut_area", brief(resection->cut_area)},
          {"mean_distance", number_or_null(resection->mean_distance)},
          {"farthest", number_or_null(resection->furthest)},
          {"mean_parted_distance", number_or_null(resection->mean_separated_distance)},
          {"loose_pieces", resection->loose_pieces}};
}

}  // namespace

std::string state_text(const Picture& picture, std::span<const SeenPeer> peers, const MeasuredRates& rates,
                       bool paused) {
  Json tools = Json::array();
  for (const SeenTool& tool : std::span(picture.tools).first(peers.size())) tools.push_back(seen_json(tool));
  return dumped({{"state",
                  {{"t", std::round(1e4 * picture.t) / 1e4},
                   {"step", picture.step},
                   {"paused", paused},
                   {"step_ms", brief(picture.step_ms)},
                   {"late", picture.late},
                   {"rate_hz", number_or_null(rates.steps_hz)},
                   {"real_time_factor", number_or_null(rates.real_time_factor)},
                   {"tools", tools},
                   {"resection", resection_json(picture.resection)},
                   {"strain", picture.strain ? picture.strain->to_text() : ""},
                   {"peers", peers_json(peers)}}}});
}

std::string client_text(const SeenClient& client) {
  Json laws = Json::array(), errors = Json::array(), parts = Json::object(), interventions = Json::object();
  for (std::size_t i = 0; i < client.laws; ++i) {
    laws.push_back(text_of(client.law_names[i]));
    errors.push_back(number_or_null(static_cast<double>(client.errors_percent[i])));
  }
  for (std::size_t i = 1; i < SeenClient::kMostParts && client.part_names[i][0] != 0; ++i)
    parts[text_of(client.part_names[i])] = number_or_null(static_cast<double>(client.parts_percent[i]));
  Json states = Json::array();
  for (std::size_t i = 0; i < client.states; ++i) states.push_back(text_of(client.state_names[i]));
  for (std::size_t i = 0; i < client.interventions; ++i)
    interventions[text_of(client.intervention_names[i])] = client.intervention_counts[i];
  return dumped({{"client",
                  {{"tool", client.tool},
                   {"law", text_of(client.law)},
                   {"laws", laws},
                   {"errors_percent", errors},
                   {"total_percent", number_or_null(static_cast<double>(client.parts_percent[0]))},
                   {"parts_percent", parts},
                   {"age_ms", brief(client.age_ms)},
                   {"beside", beside_the_hand(client.age_ms)},
                   {"period_ms", brief(client.period_ms)},
                   {"missed", client.missed},
                   {"passivity_gain", brief(client.passivity_gain)},
                   {"interventions", interventions},
                   {"states", states},
                   {"felt", brief(client.rendered_W)},
                   {"p", brief(client.p_W)},
                   {"device", text_of(client.device)},
                   {"has_motors", client.has_motors}}}});
}

std::string refused_text(const std::string& why) {
  return dumped({{"refused", why}});
}

}  // namespace palpate::sim
