// SPDX-License-Identifier: Apache-2.0
// tests/apps/mesh/random_ply.hpp: PLY files of random layout, each with the mesh that it holds. They are written value
// by value, without the program's writer.
#pragma once

#include <algorithm>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/triangle_mesh.hpp"

namespace palpate {

struct RandomPly {
  std::string bytes;
  std::size_t header_bytes = 0;
  TriangleMesh mesh;
};

enum class RandomPlyForm { kText, kLittleEndian, kBigEndian };

class RandomPlyMaker {
 public:
  RandomPlyMaker(std::mt19937& random, RandomPlyForm form) : random_(random), form_(form) {}

  // A file whose elements are in random order and have properties that a reader of meshes must skip. The type of corner
  // numbers is one of `corner_types`, such as "int" and "uchar". `triangles_only`: no other polygons, and no second
  // list.
  RandomPly make(const std::vector<std::string>& corner_types, bool triangles_only = false) {
    triangles_only_ = triangles_only;
    const char* const forms[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    header_ = fmt::format("ply\nformat {} 1.0\ncomment made at random\n", forms[static_cast<int>(form_)]);
    vertices_ = 3 + below(20);
    for (std::size_t n = 0; n < vertices_; ++n) {
      ply_.mesh.vertices_W.emplace_back(coordinate(), coordinate(), coordinate());
    }
    std::vector<int> order = {0, 1, 2};
    std::shuffle(order.begin(), order.end(), random_);
    for (const int which : order) {
      if (which == 0) addVertices();
      if (which == 1) addFaces(corner_types[below(corner_types.size())]);
      if (which == 2) addEdges();
    }
    ply_.bytes = header_ + "end_header\n";
    ply_.header_bytes = ply_.bytes.size();
    ply_.bytes += values_;
    return ply_;
  }

 private:
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_()) % count; }
  double coordinate() { return (static_cast<double>(below(2001)) - 1000) / 8; }  // a float, and short as a text

  // Writes a number, which the type can hold.
  void put(const std::string& type, double number) {
    if (form_ == RandomPlyForm::kText) {
      values_ += fmt::format("{}{}", values_.empty() || values_.back() == '\n' ? "" : " ", number);
      return;
    }
    if (type == "double" || type == "float64") return putBytes(number);
    if (type == "float" || type == "float32") return putBytes(static_cast<float>(number));
    if (type == "uchar" || type == "uint8") return putBytes(static_cast<std::uint8_t>(number));
    if (type == "short" || type == "int16") return putBytes(static_cast<std::int16_t>(number));
    if (type == "ushort" || type == "uint16") return putBytes(static_cast<std::uint16_t>(number));
    if (type == "uint" || type == "uint32") return putBytes(static_cast<std::uint32_t>(number));
    putBytes(static_cast<std::int32_t>(number));
  }
  template <class T>
  void putBytes(T number) {
    std::string raw(reinterpret_cast<const char*>(&number), sizeof number);
    if (form_ == RandomPlyForm::kBigEndian) std::reverse(raw.begin(), raw.end());
    values_ += raw;
  }
  void endLine() {
    if (form_ == RandomPlyForm::kText) values_ += '\n';
  }

  void addVertices() {
    const std::string type = std::vector<std::string>{"float", "double", "float32", "float64"}[below(4)];
    std::vector<std::string> names = {"x", "y", "z", "red", "quality"};
    std::shuffle(names.begin(), names.end(), random_);
    header_ += fmt::format("element vertex {}\n", vertices_);
    for (const std::string& name : names) {
      header_ += fmt::format("property {} {}\n", name == "red" ? "uchar" : name == "quality" ? "short" : type, name);
    }
    for (const Vec3& vertex : ply_.mesh.vertices_W) {
      for (const std::string& name : names) {
        if (name == "red") {
          put("uchar", static_cast<double>(below(256)));
        } else if (name == "quality") {
          put("short", static_cast<double>(below(65536)) - 32768);
        } else {
          put(type, vertex[static_cast<int>(name[0] - 'x')]);
        }
      }
      endLine();
    }
  }

  void addFaces(const std::string& type) {
    const std::size_t faces = 1 + below(30);
    const bool list_first = below(2) == 0;
    const std::string count_type = below(2) == 0 ? "uchar" : "int";
    const std::string list =
        fmt::format("property list {} {} {}\n", count_type, type, below(2) == 0 ? "vertex_indices" : "vertex_index");
    std::string others = "property uint id\n";
    if (!triangles_only_) others += "property list uint16 float texture\n";
    header_ += fmt::format("element face {}\n", faces) + (list_first ? list + others : others + list);
    for (std::size_t face = 0; face < faces; ++face) {
      if (!list_first) addOthers();
      std::vector<std::uint32_t> corners(triangles_only_ ? 3 : 3 + below(3));
      for (std::uint32_t& corner : corners) corner = static_cast<std::uint32_t>(below(vertices_));
      put(count_type, static_cast<double>(corners.size()));
      for (const std::uint32_t corner : corners) put(type, corner);
      for (std::size_t n = 2; n < corners.size(); ++n) {
        ply_.mesh.triangles.push_back({corners[0], corners[n - 1], corners[n]});
      }
      if (list_first) addOthers();
      endLine();
    }
  }
  void addOthers() {
    put("uint", static_cast<double>(below(4'000'000'000)));
    if (triangles_only_) return;
    const std::size_t items = below(4);
    put("uint16", static_cast<double>(items));
    for (std::size_t n = 0; n < items; ++n) put("float", coordinate());
  }

  void addEdges() {
    const std::size_t edges = below(5);
    header_ += fmt::format("element edge {}\nproperty int16 from\nproperty int to\n", edges);
    for (std::size_t n = 0; n < edges; ++n) {
      put("int16", static_cast<double>(below(100)));
      put("int", -static_cast<double>(below(100000)));
      endLine();
    }
  }

  std::mt19937& random_;
  RandomPlyForm form_;
  RandomPly ply_;
  std::string header_, values_;
  std::size_t vertices_ = 0;
  bool triangles_only_ = false;
};

}  // namespace palpate
