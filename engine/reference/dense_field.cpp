// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

DenseField denseField(const Volume& volume) {
  return {volume.size(), volume.lattice(), volume.toDense()};
}

}  // namespace palpate::reference
