// SPDX-License-Identifier: Apache-2.0
#include "engine/field/border_facets.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace palpate {
namespace {

// One square. Its corners and edges have the numbers of faceCorners(): edge n leads from corner n to corner n + 1, and
// n goes on after 3 with 0. All is counter-clockwise, seen from outside of the object.
class BorderSquare {
 public:
  BorderSquare(const SurfaceCell& cell, int face, const SharedVertices& vertices, TriangleMesh& mesh)
      : cell_(cell),
        face_(face),
        vertices_(vertices),
        mesh_(mesh),
        corners_(faceCorners(face)),
        lines_(faceLines(cell.inside, cell.joined, face)) {
    // The square is seen from the cell, which is beyond the border: on a lower face that is against the axis, as the
    // corners are in order, on an upper face along it.
    if (face % 2 == 1) std::swap(corners_[1], corners_[3]);
  }

  void add() {
    int count = 0;
    for (int n = 0; n < 4; ++n) count += isInside(n) ? 1 : 0;
    if (count == 4) return addFan(voxel(0), {voxel(1), voxel(2), voxel(3)});
    for (int n = 0; n < 4; ++n) {
      if (count == 1 && isInside(n)) return addFan(voxel(n), lineFrom(n));
      if (count == 3 && !isInside(n)) return addAllBut(n);
      if (count == 2 && isInside(n) && isInside(n + 1)) return addHalf(n);
    }
    if (count == 2) addDiagonal(isInside(0) ? 0 : 1);
  }

 private:
  using Vertices = std::vector<std::uint32_t>;

  [[nodiscard]] int corner(int n) const { return corners_[static_cast<std::size_t>((n + 4) % 4)]; }
  [[nodiscard]] bool isInside(int n) const { return (cell_.inside >> corner(n) & 1) != 0; }
  [[nodiscard]] std::uint32_t voxel(int n) const { return vertices_.atCorner(cell_, corner(n)); }

  // The vertices of the line at edge n, beginning there: two or three.
  [[nodiscard]] Vertices lineFrom(int n) const {
    const int edge = edgeBetween(corner(n), corner(n + 1));
    const int line = lines_.count == 2 && (lines_.lines[1].from == edge || lines_.lines[1].to == edge) ? 1 : 0;
    const FaceLine& ends = lines_.lines[static_cast<std::size_t>(line)];
    Vertices found = {vertices_.onEdge(cell_, ends.from)};
    const std::uint32_t bend = vertices_.onLine(cell_, face_, line);
    if (bend != kNoVertex) found.push_back(bend);
    found.push_back(vertices_.onEdge(cell_, ends.to));
    if (ends.from != edge) std::reverse(found.begin(), found.end());
    return found;
  }

  void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh_.triangles.push_back({a, b, c}); }
  void addFan(std::uint32_t apex, const Vertices& others) {
    for (std::size_t n = 0; n + 1 < others.size(); ++n) addTriangle(apex, others[n], others[n + 1]);
  }

  // The line is a falling hyperbola around corner n: the opposite corner sees all of it.
  void addAllBut(int n) {
    const Vertices line = lineFrom(n - 1);
    addTriangle(voxel(n + 2), voxel(n + 3), line.front());
    addFan(voxel(n + 2), line);
    addTriangle(voxel(n + 2), line.back(), voxel(n + 1));
  }

  // The line goes from edge n + 1 to edge n - 1. Beside its middle vertex, each corner has its own half.
  void addHalf(int n) {
    const Vertices line = lineFrom(n + 1);
    addTriangle(voxel(n), voxel(n + 1), line[1]);
    if (line.size() == 2) return addTriangle(voxel(n + 1), line[0], line[1]);
    addTriangle(voxel(n + 1), line[0], line[1]);
    addTriangle(voxel(n), line[1], line[2]);
  }

  // The corners n and n + 2 are inside.
  void addDiagonal(int n) {
    const Vertices first = lineFrom(n), second = lineFrom(n + 2);
    const bool joined = (cell_.joined >> face_ & 1) != 0;
    if (!joined) {
      addFan(voxel(n), first);
      addFan(voxel(n + 2), second);
      return;
    }
    // The lines lie on either side of the saddle, and so do their middle vertices, or their ends. The edge between
    // these parts what is n's from what is n + 2's.
    const std::size_t first_middle = first.size() == 3 ? 1 : 0, second_middle = second.size() == 3 ? 1 : 0;
    for (std::size_t k = 0; k + 1 < first.size(); ++k)
      addTriangle(voxel(k < first_middle ? n : n + 2), first[k], first[k + 1]);
    for (std::size_t k = 0; k + 1 < second.size(); ++k)
      addTriangle(voxel(k < second_middle ? n + 2 : n), second[k], second[k + 1]);
    addTriangle(voxel(n), first[first_middle], second[second_middle]);
    addTriangle(voxel(n + 2), second[second_middle], first[first_middle]);
  }

  const SurfaceCell& cell_;
  int face_;
  const SharedVertices& vertices_;
  TriangleMesh& mesh_;
  std::array<int, 4> corners_;
  FaceLines lines_;
};

}  // namespace

void addBorderFacets(const SurfaceCell& cell, const SharedVertices& vertices, TriangleMesh& mesh) {
  for (int face = 0; face < 6; ++face) {
    if (vertices.holdsFace(cell, face)) BorderSquare(cell, face, vertices, mesh).add();
  }
}

}  // namespace palpate
