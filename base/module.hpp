// SPDX-License-Identifier: Apache-2.0
// base/module.hpp: parts of the program that are loaded when they are first used.
//
// A module is a shared library of Palpate, lib/palpate/NAME.so beside the program's folder. It holds the code that uses
// one outside library (ITK, OpenVDB, Embree, ...), so that a run that does not need the library does not load it. The
// program calls it through a table: a struct of function pointers that the module defines as a constant and that names
// module and constant,
//
//   struct EmbreeModule {
//     static constexpr const char* kModule = "embree";
//     static constexpr const char* kTable = "palpate_embree";
//     std::unique_ptr<MeshTree> (*build)(...);
//   };
//
// A module has its own copy of the functions of other rooms that it uses, and no state: what both sides must share is
// handed over. An Error that a module throws is caught as an Error. A module is never unloaded.
// Thread: any. But whoever forks afterwards and uses the module in the child must load it before: another thread may
// hold the loader's lock. Cost: the first call loads the module and its library, 1 to 50 ms; later calls cost nothing.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

namespace palpate {

// The file of a module: "embree" is ../lib/palpate/embree.so from the program's own folder.
[[nodiscard]] std::filesystem::path moduleFile(const std::string& name);

// The constant `table` of the module in `file`, which is loaded if it is not. Throws Error(kNotFound): no such file,
// one that the loader refuses (it says why: mostly a library that is not installed), one of another version of Palpate,
// or one without that constant.
[[nodiscard]] const void* moduleTable(const std::filesystem::path& file, const std::string& table);

// The table itself. Throws as above, at each call until the module can be loaded.
template <class Table>
[[nodiscard]] const Table& loadModule() {
  static const auto& table = *static_cast<const Table*>(moduleTable(moduleFile(Table::kModule), Table::kTable));
  return table;
}

// For a process that soon cannot load anything (service/sandbox): loads these now. One that cannot be loaded is told
// by loadModule(), when it is needed, which then also says to start the servo again. Before other threads.
void loadAhead(std::initializer_list<const char*> names) noexcept;

}  // namespace palpate
