#include "common/contact/narrow_phase.h"

#include <algorithm>

#include "common/contact/simplex_distance.h"

namespace palpate {
namespace {

constexpr double kNearPivot = 0.02;  // share of the shaft next to the pivot that carries nothing to the tip

/// The contact of a feature of `corners` (all, or two of them, or one): those with weight, in ascending
/// order, so that neighbours agree.
Contact contact_on(std::array<int, 3> corners, const std::array<double, 3>& weight, int size) noexcept {
  Contact contact{{-1, -1, -1}, {0, 0, 0},    0, Contact::kTip, Vec3::Zero(), 0, 0,
                  Vec3::Zero(), Vec3::Zero(), 1};
  std::array<int, 3> order{0, 1, 2};
  std::ranges::sort(order, [&](int a, int b) { return corners[a] < corners[b]; });
  for (const int c : order) {
    if (size < 3 && weight[c] == 0) continue;
    contact.node[contact.size] = corners[c];
    contact.weight[contact.size++] = weight[c];
  }
  return contact;
}

struct Search {
  std::span<const Vec3> x;
  const Vec3& tip;
  double margin;
  std::vector<Contact>& contacts;
  std::size_t first = contacts.size();  // those before are of other tools
  bool complete = true;                 // there was room for all

  void add(Contact contact, Contact::Part part, const Vec3& on_axis, const Vec3& to_tool, double radius,
           const Vec3& face) noexcept {
    const auto same = [&](const Contact& other) { return other.node == contact.node && other.part == part; };
    if (std::ranges::any_of(std::span(contacts).subspan(first), same)) return;
    complete &= contacts.size() < contacts.capacity();
    if (!complete) return;
    contact.part = part;
    contact.distance = to_tool.norm();
    contact.radius = radius;
    contact.arm = on_axis - to_tool - tip;
    // An axis exactly on the surface has no direction of its own: take the face's.
    contact.normal = contact.distance > 0 ? Vec3(to_tool / contact.distance) : face.normalized();
    contacts.push_back(contact);
  }

  void add_ball(const std::array<int, 3>& triangle, Contact::Part part, const Vec3& p,
                double radius) noexcept {
    const Vec3 &a = x[triangle[0]], &b = x[triangle[1]], &c = x[triangle[2]];
    const ClosestPoint closest = closest_point(p, a, b, c);
    const Vec3 to_tool = p - (closest.weight[0] * a + closest.weight[1] * b + closest.weight[2] * c);
    if (to_tool.norm() > radius + margin) return;
    add(contact_on(triangle, closest.weight, closest.feature_size), part, p, to_tool, radius,
        (b - a).cross(c - a));
  }

  /// The edges of a triangle against the inside of the axis.
  void add_shaft(const std::array<int, 3>& triangle, const Tool& tool, const Vec3& far) noexcept {
    const double radius = tool.trocar ? tool.trocar->shaft_radius : tool.radius;
    for (int i = 0; i < 3; ++i) {
      const int from = triangle[i], to = triangle[(i + 1) % 3];
      const Vec3 &a = x[from], &b = x[to];
      const auto [s, t] = closest_pair(far, tip, a, b);
      if (s >= 1 || s <= (tool.trocar ? kNearPivot : 0.0)) continue;  // its ends do that
      const Vec3 on_axis = far + s * (tip - far), to_tool = on_axis - (a + t * (b - a));
      if (to_tool.norm() > radius + margin) continue;
      Contact contact = contact_on({from, to, -1}, {1 - t, t, 0}, 2);
      contact.axis = tool.trocar ? Vec3(tip - far) : Vec3((tip - far).normalized());
      contact.fraction = tool.trocar ? s : 1;
      add(contact, Contact::kShaft, on_axis, to_tool, radius, (b - a).cross(x[triangle[(i + 2) % 3]] - a));
    }
  }
};

}  // namespace

bool find_contacts_on_patch(std::span<const Vec3> x, std::span<const std::array<int, 3>> triangles,
                            const Tool& tool, const ToolPose& pose, double margin,
                            std::vector<Contact>& contacts) noexcept {
  Search search{x, pose.p_W, margin, contacts};
  const Vec3 far = far_end(tool, pose);
  for (const auto& triangle : triangles) {
    search.add_ball(triangle, Contact::kTip, pose.p_W, tool.radius);
    if (tool.is_sphere()) continue;
    if (!tool.trocar) search.add_ball(triangle, Contact::kFarEnd, far, tool.radius);
    search.add_shaft(triangle, tool, far);
  }
  return search.complete;
}

}  // namespace palpate
