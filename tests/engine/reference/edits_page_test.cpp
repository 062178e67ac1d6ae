// SPDX-License-Identifier: Apache-2.0
// What docs/edits.md says, computed from the page's own text: the block of formulas is read and evaluated in floats,
// each operation rounded by itself, as the page says. The twin must have the same bits. (The kernels have the twin's:
// tests/engine/service/editor_test.cpp.)
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/edit/lower_edit.hpp"
#include "engine/edit/random_edits.hpp"
#include "engine/reference/edited_density.hpp"

namespace palpate {
namespace edits_page_test {

constexpr float kLargest = std::numeric_limits<float>::max();

using Formulas = std::map<std::string, std::string>;

Formulas formulasOf(const std::string& path) {
  std::ifstream in(path);
  Formulas formulas;
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) {
      inside = line == "```formulas";
    } else if (const auto equals = line.find(" = "); inside && equals != std::string::npos) {
      formulas[line.substr(0, equals)] = line.substr(equals + 3);
    }
  }
  return formulas;
}

// Names are given numbers, or other formulas. Throws std::runtime_error for what is neither.
class Evaluator {
 public:
  Evaluator(const Formulas& formulas, std::map<std::string, float> known)
      : formulas_(&formulas), known_(std::move(known)) {}

  float operator()(const std::string& name) {
    if (const auto found = known_.find(name); found != known_.end()) return found->second;
    const auto formula = formulas_->find(name);
    if (formula == formulas_->end()) throw std::runtime_error("the page does not say what " + name + " is");
    Reader reader{*this, formula->second};
    const float value = reader.sum();
    if (reader.next() != '\0') throw std::runtime_error("cannot read " + formula->second);
    return known_[name] = value;
  }

  void know(const std::string& name, float value) { known_[name] = value; }
  // The same with one name more.
  [[nodiscard]] Evaluator with(const std::string& name, float value) const {
    Evaluator more = *this;
    more.know(name, value);
    return more;
  }

 private:
  struct Reader {
    Evaluator& names;
    const std::string& text;
    std::size_t at = 0;

    char next() {
      while (at < text.size() && text[at] == ' ') ++at;
      return at < text.size() ? text[at] : '\0';
    }
    bool takes(char c) {
      if (next() != c) return false;
      ++at;
      return true;
    }
    void need(char c) {
      if (!takes(c)) throw std::runtime_error(text + ": no " + c);
    }
    float sum() {
      float value = product();
      for (;;) {
        if (takes('+')) {
          value = value + product();
        } else if (takes('-')) {
          value = value - product();
        } else {
          return value;
        }
      }
    }
    float product() {
      float value = factor();
      while (takes('*')) value = value * factor();
      return value;
    }
    float factor() {
      if (takes('(')) {
        const float value = sum();
        need(')');
        return value;
      }
      const char first = next();
      const std::size_t begin = at;
      while (at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_')) ++at;
      const std::string word = text.substr(begin, at - begin);
      if (std::isdigit(static_cast<unsigned char>(first)) != 0) return std::stof(word);
      if (!takes('(')) return names(word);
      std::vector<float> given = {sum()};
      while (takes(',')) given.push_back(sum());
      need(')');
      return call(word, given);
    }
    static float call(const std::string& name, const std::vector<float>& x) {
      if (name == "min") return std::min(x.at(0), x.at(1));
      if (name == "max") return std::max(x.at(0), x.at(1));
      if (name == "clamp") return std::min(std::max(x.at(0), x.at(1)), x.at(2));
      if (name == "sqrt") return std::sqrt(x.at(0));
      if (name == "floor") return std::floor(x.at(0));
      if (name == "finite") return std::min(std::max(x.at(0), -kLargest), kLargest);
      throw std::runtime_error("no function " + name);
    }
  };

  const Formulas* formulas_;
  std::map<std::string, float> known_;
};

const char* targetOf(layout::uint kind) {
  switch (kind) {
    case EDIT_ADD:
      return "add";
    case EDIT_REMOVE:
      return "remove";
    case EDIT_PAINT:
      return "paint";
    case EDIT_FLATTEN:
      return "flatten";
    case EDIT_CUT:
      return "cut";
    case EDIT_SMOOTH:
      return "smooth";
    case EDIT_STAMP_ADD:
      return "stamp_add";
    case EDIT_STAMP_REMOVE:
      return "stamp_remove";
    default:
      return "inflate";
  }
}

// The page's names with the stamp's lattice and the corners of the cell around the voxel. Empty outside the lattice.
std::optional<Evaluator> inStamp(const Evaluator& page, const layout::EditCommand& c, std::span<const float> stamps) {
  const std::array<std::array<float, 4>, 3> m = {
      {{c.m_xx, c.m_xy, c.m_xz, c.m_xt}, {c.m_yx, c.m_yy, c.m_yz, c.m_yt}, {c.m_zx, c.m_zy, c.m_zz, c.m_zt}}};
  const std::array<std::size_t, 3> size = {c.stamp_x, c.stamp_y, c.stamp_z};
  Evaluator stamp = page;
  std::array<std::size_t, 3> cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    for (std::size_t n = 0; n < 4; ++n) stamp.know("m" + name + "xyzt"[n], m[axis][n]);
    const auto last = static_cast<float>(size[axis] - 1);
    stamp.know("last_" + name, last);
    const float at = stamp("at_" + name);
    if (at < 0 || at > last) return std::nullopt;
    cell[axis] = static_cast<std::size_t>(stamp("cell_" + name));
  }
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t dx = corner & 1U, dy = corner >> 1U & 1U, dz = corner >> 2U;
    const std::size_t voxel = ((cell[2] + dz) * size[1] + cell[1] + dy) * size[0] + cell[0] + dx;
    stamp.know(fmt::format("u{}{}{}", dx, dy, dz), stamps[c.stamp_first + voxel]);
  }
  return stamp;
}

// What the page makes of a voxel.
float byThePage(const Formulas& formulas, const layout::EditCommand& c, const layout::EditScale& scale,
                std::span<const float> stamps, const Vec3i& voxel, float f, const reference::Neighbours& around) {
  const float sign = c.kind == EDIT_DEFLATE ? -1.0F : 1.0F;
  std::map<std::string, float> known = {{"px", static_cast<float>(voxel.x() - c.origin_x) * scale.h_x},
                                        {"py", static_cast<float>(voxel.y() - c.origin_y) * scale.h_y},
                                        {"pz", static_cast<float>(voxel.z() - c.origin_z) * scale.h_z},
                                        {"ax", c.a_x},
                                        {"ay", c.a_y},
                                        {"az", c.a_z},
                                        {"abx", c.ab_x},
                                        {"aby", c.ab_y},
                                        {"abz", c.ab_z},
                                        {"inv_ab2", c.inv_ab2},
                                        {"r", c.radius},
                                        {"nx", c.n_x},
                                        {"ny", c.n_y},
                                        {"nz", c.n_z},
                                        {"nP", c.n_d},
                                        {"inv_F", c.inv_fade},
                                        {"strength", c.strength},
                                        {"drop", c.material_drop},
                                        {"low", c.material_low},
                                        {"inv_range", c.material_inv_range},
                                        {"tau", c.isovalue},
                                        {"slope", c.slope},
                                        {"object", c.object},
                                        {"background", c.background},
                                        {"value", c.value},
                                        {"half", c.value},
                                        {"f", sign * f},
                                        {"cx", scale.blur_x},
                                        {"cy", scale.blur_y},
                                        {"cz", scale.blur_z},
                                        {"inv_hx", scale.inv_h_x},
                                        {"inv_hy", scale.inv_h_y},
                                        {"inv_hz", scale.inv_h_z}};
  float densest = sign * f;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = std::string("f") + "xyz"[axis];
    known[name + "0"] = sign * around.before[axis];
    known[name + "1"] = sign * around.after[axis];
    densest = std::max({densest, sign * around.before[axis], sign * around.after[axis]});
  }
  known["densest"] = densest;
  if (c.inv_ab2 == 0) known["t"] = 0;
  if (c.inv_fade == 0) known["w"] = 1;
  Evaluator page(formulas, std::move(known));
  float a = c.strength;
  if (c.kind == EDIT_CUT) {
    if (page("height") < -c.reach) return f;
  } else if (c.kind == EDIT_STAMP_ADD || c.kind == EDIT_STAMP_REMOVE) {
    const std::optional<Evaluator> stamp = inStamp(page, c, stamps);
    if (!stamp) return f;
    page = *stamp;
    if (page("u") > c.reach) return f;
  } else {
    if (page("d") > c.reach) return f;
    a = page("fade");
  }
  if (c.kind == EDIT_REMOVE && c.material_drop != 0) a = a * page("material");
  if (!(a > 0)) return f;
  Evaluator with_a = page.with("a", a);
  const float g = with_a(targetOf(c.kind));
  if (reference::readsNeighbours(c)) return sign * g;
  return a >= 1 ? g : with_a.with("g", g)("step");
}

TEST(EditsPage, SaysWhatTheTwinDoes) {
  const Formulas formulas = formulasOf(PALPATE_DOCS "/edits.md");
  ASSERT_GT(formulas.size(), 20U);
  const Vec3i size(21, 18, 16);
  Lattice lattice;
  lattice.spacing_m = {0.7e-3, 0.9e-3, 2.1e-3};
  lattice.R_WL = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).matrix();
  const BrushProfile profile = brushProfile(30, -100, 200, lattice.spacing_m);
  RandomEdits edits(size, lattice, -100, 200, 11);
  std::map<layout::uint, int> changed;
  for (int n = 0; n < 300; ++n) {
    const EditCommand command = edits.next();
    const LoweredEdits lowered = lowerEdits(std::span(&command, 1), size, lattice, profile);
    const layout::EditCommand& c = lowered.commands[0];
    const layout::EditScale scale = editScale(lattice.spacing_m);
    for (int sample = 0; sample < 150; ++sample) {
      const Vec3i voxel(static_cast<int>(edits.pick(21)), static_cast<int>(edits.pick(18)),
                        static_cast<int>(edits.pick(16)));
      const auto density = [&] { return static_cast<float>(edits.between(-150, 250)); };
      const float f = density();
      reference::Neighbours around;
      for (std::size_t axis = 0; axis < 3; ++axis) around.before[axis] = density(), around.after[axis] = density();
      const float twin = reference::editedDensity(c, scale, lowered.stamps, voxel, f, around);
      const float page = byThePage(formulas, c, scale, lowered.stamps, voxel, f, around);
      ASSERT_EQ(std::bit_cast<std::uint32_t>(twin), std::bit_cast<std::uint32_t>(page))
          << editName(command.kind) << " at " << voxel.transpose() << ": " << f << " to " << twin << ", by the page "
          << page;
      if (twin != f) ++changed[c.kind];
    }
  }
  EXPECT_EQ(changed.size(), 10U) << "a kind of edit changed no voxel";
  for (const auto& [kind, count] : changed) EXPECT_GT(count, 20) << targetOf(kind);
}

// An edit made twice, at every voxel: the same as once, exactly for the kinds and keys that the page names.
TEST(EditsPage, TwiceIsOnceWhereItSaysSo) {
  const Vec3i size(14, 13, 12);
  const Lattice lattice{Vec3::Zero(), Mat3::Identity(), {0.7e-3, 0.9e-3, 1.1e-3}};
  const BrushProfile profile = brushProfile(30, -100, 200, lattice.spacing_m);
  RandomEdits edits(size, lattice, -100, 200, 12);
  int same = 0, going_on = 0;
  for (int n = 0; n < 400; ++n) {
    EditCommand command = edits.next();
    if (command.kind != EditKind::kAdd && command.kind != EditKind::kRemove && command.kind != EditKind::kCut &&
        !isStamp(command.kind))
      continue;
    const bool has_falloff = isBrush(command.kind) && command.falloff > 0;
    const bool has_material = command.kind == EditKind::kRemove && command.material && command.material->drop > 0;
    const bool once = command.strength == 1 && !has_falloff && !has_material;
    const LoweredEdits lowered = lowerEdits(std::span(&command, 1), size, lattice, profile);
    bool differs = false;
    for (int v = 0; v < size.prod(); ++v) {
      const Vec3i voxel(v % size.x(), v / size.x() % size.y(), v / size.x() / size.y());
      const auto edited = [&](float f) {
        return reference::editedDensity(lowered.commands[0], editScale(lattice.spacing_m), lowered.stamps, voxel, f,
                                        {});
      };
      const float first = edited(static_cast<float>(edits.between(-150, 250)));
      differs = differs || std::bit_cast<std::uint32_t>(edited(first)) != std::bit_cast<std::uint32_t>(first);
    }
    EXPECT_FALSE(once && differs) << editName(command.kind);
    same += once ? 1 : 0;
    going_on += !once && differs ? 1 : 0;
  }
  EXPECT_GT(same, 20);
  EXPECT_GT(going_on, 20);
}

}  // namespace edits_page_test
}  // namespace palpate
