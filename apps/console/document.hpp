// SPDX-License-Identifier: Apache-2.0
// apps/console/document.hpp: text with Markdown tables, as a page for files and with aligned columns for people.
//
// The rule stands here alone: on a terminal tables are aligned, anywhere else (a file, a pipe) the text stays what it
// is, so that `palpate scene > docs/scene.md` writes a page. Set-up code, one thread.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

// printText() of the document; with aligned tables if standard output is a terminal.
void printDocument(std::string_view document);

// The document with each table (rows that begin with '|', the second of them |---|) as columns with two blanks between,
// a line of dashes under the heading and no backticks. `width`: of the terminal [column]. Where a table is wider,
// words of its widest columns go on in the next line; a column is never narrower than its longest word. "---:" aligns
// to the right. What is no table stays as it is.
[[nodiscard]] std::string alignedTables(std::string_view document, std::size_t width);

}  // namespace palpate
